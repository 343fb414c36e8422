// Faults of the format, and keys without effect.

#include "tests/api/case_faults.hpp"

namespace quicksand {
namespace {

using test::Mutation, test::name_of;

class CaseKeys : public test::CaseFaults {};

TEST_P(CaseKeys, GiveTheirPointers) { test::expect_faults(GetParam()); }

const Mutation of_the_format[] = {
    {"WrongVersion", ADD("/schema", R"("quicksand.case/2")"), {"/schema"}},
    {"NoVersion", REMOVE("/schema"), {"/schema"}},
    {"NoName", REMOVE("/name"), {"/name"}},
    {"UnknownTopKey", ADD("/walls_", "[]"), {"/walls_"}},
    {"UnknownNestedKey",
     ADD("/materials/soils/sand/permeability/valeu", "1"),
     {"/materials/soils/sand/permeability/valeu"}},
    {"MisspeltNeededKey", R"([{"op":"move","from":"/gates","path":"/gate"}])", {"/gate"}},
    {"WrongType", ADD("/domain/cell_size", R"("small")"), {"/domain/cell_size"}},
    {"NullWhereNumber", ADD("/domain/cell_size", "null"), {"/domain/cell_size"}},
    {"ListWhereObject", ADD("/domain", "[]"), {"/domain"}},
    {"NegativeCell", ADD("/domain/cell_size", "-0.01"), {"/domain/cell_size"}},
    {"PorosityAboveOne", ADD("/materials/soils/sand/porosity", "1.4"), {"/materials/soils/sand/porosity"}},
    {"PorosityOfOne", ADD("/materials/soils/sand/porosity", "1"), {"/materials/soils/sand/porosity"}},
    {"PoissonOfHalf",
     ADD("/materials/soils/sand/model/poisson_ratio", "0.5"),
     {"/materials/soils/sand/model/poisson_ratio"}},
    {"FractionOfPoint", ADD("/numerics/points_per_cell", "2.5"), {"/numerics/points_per_cell"}},
    {"TargetErrorOfZero", ADD("/numerics/target_error", "0"), {"/numerics/target_error"}},
    {"TargetErrorAboveOne", ADD("/numerics/target_error", "1.5"), {"/numerics/target_error"}},
    {"BudgetBelowZero", ADD("/numerics/budget_seconds", "-1"), {"/numerics/budget_seconds"}},
    {"UnknownChoice", ADD("/numerics/preset", R"("coarse")"), {"/numerics/preset"}},
    {"UnknownLaw", ADD("/materials/soils/sand/model/law", R"("mohr")"), {"/materials/soils/sand/model/law"}},
    {"WaterStiffnessAsWord",
     ADD("/materials/water/bulk_modulus", R"("stiff")"),
     {"/materials/water/bulk_modulus"}},
    {"WaterStiffnessZero", ADD("/materials/water/bulk_modulus", "0"), {"/materials/water/bulk_modulus"}},
    {"NoStage", ADD("/stages", "[]"), {"/stages"}},
    {"ZeroDuration", ADD("/stages/1/duration", "0"), {"/stages/1/duration"}},
    {"NoBodies", REMOVE("/bodies"), {"/bodies"}},
    {"EmptyRegion", ADD("/bodies/4/region", "{}"), {"/bodies/4/region"}},
    {"TwoRegions", ADD("/bodies/4/region/polygon", "[[0,0],[1,0],[0,1]]"), {"/bodies/4/region"}},
    {"TwoCorners", ADD("/bodies/3/region/polygon", "[[0,0],[1,0]]"), {"/bodies/3/region/polygon"}},
    {"BadCorner", SET("/bodies/3/region/polygon/1/0", R"("x")"), {"/bodies/3/region/polygon/1/0"}},
    {"DifferenceOfOne", REMOVE("/bodies/1/region/difference/1"), {"/bodies/1/region/difference"}},
    {"RadiusMissing",
     ADD("/bodies/4/region", R"({"disc":{"center":[0.4,0.3]}})"),
     {"/bodies/4/region/disc/radius"}},
    {"SlashInName", ADD("/gates/0/name", R"("a/b")"), {"/gates/0/name"}},
    {"SlashInSoilName",
     ADD("/materials/soils/a~1b",
         R"({"permeability":{"value":1e-4},"model":{"law":"linear_elastic","young_modulus":1e6,"poisson_ratio":0.3}})"),
     {"/materials/soils/a~1b"}},
    {"ThreeNumbersInThePlane", ADD("/gravity", "[0,-9.81,0]"), {"/gravity"}},
    {"OneNumber", ADD("/domain/max", "[0.6]"), {"/domain/max"}},
    {"UnknownField", SET("/output/fields/0", R"("presure")"), {"/output/fields/0"}},
    {"NoSuchQuantity", ADD("/output/probes/0/quantity", R"("colour")"), {"/output/probes/0/quantity"}},
};

const Mutation of_keys_without_effect[] = {
    {"HeadOfClosedSide", ADD("/domain/sides/bottom/head", "1"), {"/domain/sides/bottom/head"}},
    {"FrontInThePlane", ADD("/domain/sides/front", R"({"kind":"slip"})"), {"/domain/sides/front"}},
    {"GrainSizeWithoutErgun",
     ADD("/materials/soils/sand/permeability/grain_size", "1e-3"),
     {"/materials/soils/sand/permeability/grain_size"}},
    {"ExponentWithoutPower",
     ADD("/materials/soils/sand/permeability/exponent", "2"),
     {"/materials/soils/sand/permeability/exponent"}},
    {"SlopeOfElasticSoil",
     ADD("/materials/soils/plate/model/swelling_slope", "0.1"),
     {"/materials/soils/plate/model/swelling_slope"}},
    {"OverConsolidationOfSand",
     ADD("/materials/soils/sand/model/over_consolidation_ratio", "1"),
     {"/materials/soils/sand/model/over_consolidation_ratio"}},
    {"StiffnessMissing",
     REMOVE("/materials/soils/sand/model/young_modulus"),
     {"/materials/soils/sand/model/young_modulus"}},
    {"SofteningWithoutResidual",
     ADD("/materials/soils/sand/model/softening_strain", "0.1"),
     {"/materials/soils/sand/model/softening_strain"}},
    {"HeadsRampWithoutHeads", ADD("/stages/0/heads_ramp", "1"), {"/stages/0/heads_ramp"}},
    {"TransitsWithoutQuasiStatic",
     ADD("/numerics/quasi_static_transits", "100"),
     {"/numerics/quasi_static_transits"}},
    {"FrictionOfElasticSoil",
     ADD("/materials/soils/plate/model/friction_angle", "0"),
     {"/materials/soils/plate/model/friction_angle"}},
    {"FrictionMissing",
     REMOVE("/materials/soils/sand/model/friction_angle"),
     {"/materials/soils/sand/model/friction_angle"}},
    {"PermeabilityMissing",
     REMOVE("/materials/soils/sand/permeability"),
     {"/materials/soils/sand/permeability"}},
    {"SoilOfWater", ADD("/bodies/0/soil", R"("sand")"), {"/bodies/0/soil"}},
    {"SoilMissing", REMOVE("/bodies/3/soil"), {"/bodies/3/soil"}},
    {"VelocityOfFixed", ADD("/bodies/2/velocity", "[0,1]"), {"/bodies/2/velocity"}},
    {"K0WithoutK0", ADD("/initial/stress", R"("zero")"), {"/initial/k0"}},
    {"UniformPressureMissing", ADD("/initial/pressure", R"("uniform")"), {"/initial/uniform_pressure"}},
    {"K0OfSoilWithoutK0",
     R"([{"op":"add","path":"/materials/soils/sand/k0","value":0.5},
         {"op":"replace","path":"/initial","value":{"stress":"zero"}}])",
     {"/materials/soils/sand/k0"}},
    {"K0WhenEverySoilHasItsOwn", ADD("/materials/soils/sand/k0", "0.5"), {"/initial/k0"}},
    {"SofteningStrainMissing",
     R"([{"op":"add","path":"/materials/soils/sand/model/cohesion","value":100},
         {"op":"add","path":"/materials/soils/sand/model/residual_cohesion","value":10}])",
     {"/materials/soils/sand/model/softening_strain"}},
    {"SofteningStrainBesideNull",
     R"([{"op":"add","path":"/materials/soils/sand/model/residual_cohesion","value":null},
         {"op":"add","path":"/materials/soils/sand/model/softening_strain","value":0.1}])",
     {"/materials/soils/sand/model/softening_strain"}},
    {"SlopesMissing",
     ADD("/materials/soils/sand/model",
         R"({"law":"modified_cam_clay","poisson_ratio":0.2,"compression_slope":0.2})"),
     {"/materials/soils/sand/model/critical_state_slope", "/materials/soils/sand/model/swelling_slope"}},
    {"ConeOfCamClay",
     ADD("/materials/soils/sand/model",
         R"({"law":"modified_cam_clay","poisson_ratio":0.2,"compression_slope":0.2,"swelling_slope":0.04,)"
         R"("critical_state_slope":1,"young_modulus":1e7,"cohesion":0})"),
     {"/materials/soils/sand/model/cohesion", "/materials/soils/sand/model/young_modulus"}},
    {"ValueOfErgun",
     ADD("/materials/soils/sand/permeability",
         R"({"law":"ergun","grain_size":5e-4,"value":1e-4,"exponent":2})"),
     {"/materials/soils/sand/permeability/exponent", "/materials/soils/sand/permeability/value"}},
    {"GrainSizeMissing",
     ADD("/materials/soils/sand/permeability", R"({"law":"ergun"})"),
     {"/materials/soils/sand/permeability/grain_size"}},
    {"PicRateOfApic",
     R"([{"op":"add","path":"/numerics/transfer","value":"apic"},{"op":"add","path":"/numerics/pic_rate","value":5}])",
     {"/numerics/pic_rate"}},
    {"ToleranceOfExplicitPressure",
     ADD("/numerics/pressure", R"("explicit")"),
     {"/numerics/pressure_tolerance"}},
    {"PlateWithoutMotion",
     SET("/loads/0",
         R"({"name":"cover","kind":"plate","body":"sand","plate":{"from":[0.3,0.24],"to":[0.6,0.24]}})"),
     {"/loads/0/plate_velocity"}},
    {"PlateWithBoth",
     SET("/loads/0",
         R"({"name":"cover","kind":"plate","body":"sand","plate":{"from":[0.3,0.24],"to":[0.6,0.24]},)"
         R"("plate_velocity":[0,-1],"plate_force":[0,-1]})"),
     {"/loads/0/plate_velocity"}},
    {"TractionOfPlate",
     SET("/loads/0",
         R"({"name":"cover","kind":"plate","body":"sand","plate":{"from":[0.3,0.24],"to":[0.6,0.24]},)"
         R"("plate_velocity":[0,-1],"traction":[0,-1],"side":"top"})"),
     {"/loads/0/side", "/loads/0/traction"}},
    {"PlateMissing",
     SET("/loads/0", R"({"name":"cover","kind":"plate","body":"sand","plate_force":[0,-1]})"),
     {"/loads/0/plate"}},
    {"FrontOfAPlaneBody", ADD("/loads/0/side", R"("front")"), {"/loads/0/side"}},
    {"PlateKeysOfTraction", ADD("/loads/0/rough", "true"), {"/loads/0/rough"}},
    {"FactorOfFixedStep",
     R"([{"op":"add","path":"/numerics/time_step","value":1e-4},{"op":"add","path":"/numerics/time_step_factor","value":0.5}])",
     {"/numerics/time_step_factor"}},
    {"PresetWithTargetError", ADD("/numerics/target_error", "0.05"), {"/numerics/preset"}},
    {"CellsWithBudget",
     R"([{"op":"add","path":"/numerics/budget_seconds","value":60},{"op":"add","path":"/numerics/cell_size_factor","value":1},{"op":"remove","path":"/numerics/preset"}])",
     {"/numerics/cell_size_factor"}},
    {"ChosenByNothing", ADD("/numerics/chosen", R"("cells of 1 m")"), {"/numerics/chosen"}},
    {"TargetErrorOutOfReach",
     R"([{"op":"add","path":"/numerics/target_error","value":1e-9},{"op":"remove","path":"/numerics/preset"}])",
     {"/numerics/target_error"}},
    {"BudgetOutOfReach",
     R"([{"op":"add","path":"/numerics/budget_seconds","value":1e-9},{"op":"remove","path":"/numerics/preset"}])",
     {"/numerics/budget_seconds"}},
    {"UnusedSoil",
     ADD("/materials/soils/clay",
         R"({"permeability":{"value":1e-9},"model":{"law":"linear_elastic","young_modulus":1e6,"poisson_ratio":0.3}})"),
     {"/materials/soils/clay"}},
    {"UnusedGate", ADD("/stages/1/open_gates", "[]"), {"/gates/0"}},
    {"GateAlwaysOpen", ADD("/stages/0/open_gates", R"(["valve"])"), {"/gates/0"}},
    {"UnusedLoad", ADD("/stages/1/loads", "[]"), {"/loads/0"}},
    {"ZeroLoad", ADD("/loads/0/traction", "[0,0]"), {"/loads/0/traction"}},
};

INSTANTIATE_TEST_SUITE_P(Format, CaseKeys, testing::ValuesIn(of_the_format), name_of);
INSTANTIATE_TEST_SUITE_P(WithoutEffect, CaseKeys, testing::ValuesIn(of_keys_without_effect), name_of);

/// Damping brings water to rest as well as grains; slow processes need grains.
TEST(CaseKeysOfStages, WaterAloneCanBeDamped) {
  const auto stage = [](const char* key, const char* value) {
    return std::string(
               R"({"schema":"quicksand.case/1","name":"pool","domain":{"max":[1,1],"cell_size":0.1},)") +
           R"("bodies":[{"name":"pool","kind":"water","region":{"box":{"min":[0,0],"max":[1,0.5]}}}],)" +
           R"("stages":[{"name":"only","duration":1,")" + key + "\":" + value + "}]}";
  };
  EXPECT_TRUE(parse_case(stage("damping", "0.5")).faults.empty());
  EXPECT_EQ(test::pointers(parse_case(stage("quasi_static", "true")).faults),
            (std::vector<std::string>{"/stages/0/quasi_static"}));
}

}  // namespace
}  // namespace quicksand
