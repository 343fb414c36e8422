// Cases of the right form that make no sense: names, geometry, values against each other.

#include "tests/api/case_faults.hpp"

namespace quicksand {
namespace {

using nlohmann::json;
using test::Mutation, test::name_of, test::patched;

class CaseSense : public test::CaseFaults {};

TEST_P(CaseSense, GiveTheirPointers) { test::expect_faults(GetParam()); }

const Mutation of_names[] = {
    {"UnknownSoil", ADD("/bodies/3/soil", R"("silt")"), {"/bodies/3/soil", "/materials/soils/sand"}},
    {"UnknownGate", ADD("/stages/1/open_gates/-", R"("door")"), {"/stages/1/open_gates/1"}},
    {"GateTwice", ADD("/stages/1/open_gates/-", R"("valve")"), {"/stages/1/open_gates/1"}},
    {"UnknownReservoir", ADD("/stages/1/heads", R"({"lake":1})"), {"/stages/1/heads/lake"}},
    {"RemovesTheUnknown", ADD("/stages/1/remove_bodies", R"(["house"])"), {"/stages/1/remove_bodies/0"}},
    {"RemovesTwice",
     R"([{"op":"add","path":"/stages/0/remove_bodies","value":["pond"]},
         {"op":"add","path":"/stages/1/remove_bodies","value":["pond"]}])",
     {"/stages/1/remove_bodies/0"}},
    {"LoadOnARemovedBody",
     R"([{"op":"add","path":"/stages/1/remove_bodies","value":["sand"]},
         {"op":"add","path":"/stages/1/loads","value":["cover"]}])",
     {"/loads/0", "/stages/1/loads/0"}},
    {"UnknownLoad", ADD("/stages/0/loads/-", R"("train")"), {"/stages/0/loads/0"}},
    {"LoadOnWater", ADD("/loads/0/body", R"("pond")"), {"/loads/0/body"}},
    {"LoadOnNothing", ADD("/loads/0/body", R"("house")"), {"/loads/0/body"}},
    {"DuplicateBody", ADD("/bodies/4/name", R"("tank")"), {"/bodies/4/name"}},
    {"DuplicateStage", ADD("/stages/1/name", R"("settle")"), {"/stages/1/name"}},
    {"HeaveOfWater", ADD("/output/heave/body", R"("pond")"), {"/output/heave/body"}},
    {"HeaveProbeUnknown", ADD("/output/heave/above", R"("roof")"), {"/output/heave/above"}},
    {"HeaveProbeOfOtherQuantity", ADD("/output/probes/0/quantity", R"("porosity")"), {"/output/heave/below"}},
    {"HeaveProbesLevel", SET("/output/probes/0/at/1", "0.24"), {"/output/heave/below"}},
};

const Mutation of_geometry[] = {
    {"DomainTurned", ADD("/domain/min", "[0.7,0]"), {"/domain/max"}},
    {"DomainNotWholeCells", SET("/domain/max/0", "0.61"), {"/domain/max"}},
    {"TooManyCells", ADD("/domain/cell_size", "1e-5"), {"/domain/cell_size"}},
    {"WallOffFaces", ADD("/walls/1/line/from", "[0.43,0.4]"), {"/walls/1/line", "/walls/1/line/from"}},
    {"WallOffFacesOfDraft",
     R"([{"op":"replace","path":"/walls/1/line/from/0","value":0.45},{"op":"replace","path":"/walls/1/line/to/0","value":0.45}])",
     {"/walls/1/line/from", "/walls/1/line/to"}},
    {"WallOutside", SET("/walls/1/line/to/1", "0.8"), {"/walls/1/line/to"}},
    {"WallSlanted", SET("/walls/1/line/to/0", "0.48"), {"/walls/1/line"}},
    {"WallOfNoLength", ADD("/walls/1/line/to", "[0.44,0.4]"), {"/walls/1/line"}},
    {"WallOnEdge", ADD("/walls/1/line", R"({"from":[0.6,0.4],"to":[0.6,0.5]})"), {"/walls/1/line"}},
    {"WallOfNothing", REMOVE("/walls/1/line"), {"/walls/1"}},
    {"BlockNotBox",
     SET("/walls/1", R"({"name":"pile","block":{"disc":{"center":[0.4,0.5],"radius":0.04}}})"),
     {"/walls/1/block"}},
    {"BlockOffFaces", SET("/walls/0/block/box/max/0", "0.295"), {"/walls/0/block/box/max"}},
    {"GateOnWall",
     ADD("/walls/-", R"({"name":"plug","line":{"from":[0.24,0.04],"to":[0.24,0.08]}})"),
     {"/gates/0/line"}},
    {"GateInBlock", ADD("/gates/0/line", R"({"from":[0.24,0.2],"to":[0.24,0.3]})"), {"/gates/0/line"}},
    {"BodyOutside", SET("/bodies/4/region/box/max/0", "0.7"), {"/bodies/4/region"}},
    {"BodyTurned", SET("/bodies/4/region/box/max/1", "0.2"), {"/bodies/4/region/box"}},
    {"BodyTooThin",
     ADD("/bodies/4/region/box", R"({"min":[0.4,0.4],"max":[0.5,0.404]})"),
     {"/bodies/4/region"}},
    {"BodiesOverlap", SET("/bodies/4/region/box/min/1", "0.23"), {"/bodies/4/region"}},
    {"BodyInBlock",
     ADD("/bodies/4/region/box", R"({"min":[0.22,0.4],"max":[0.28,0.5]})"),
     {"/bodies/4/region"}},
    {"BodyIntoBlock", SET("/bodies/4/region/box/min/0", "0.28"), {"/bodies/4/region"}},
    {"PolygonCrossed",
     ADD("/bodies/3/region/polygon", "[[0.3,0.12],[0.6,0.24],[0.6,0.12],[0.3,0.24]]"),
     {"/bodies/3/region/polygon"}},
    {"FixedBodyOffFaces", SET("/bodies/2/region/box/max/1", "0.115"), {"/bodies/2/region"}},
    {"ReservoirInTheOpen",
     ADD("/reservoirs", R"([{"name":"lake","line":{"from":[0.12,0],"to":[0.12,0.2]},"head":0.5}])"),
     {"/reservoirs/0/line"}},
    {"ReservoirsOverlap",
     ADD("/reservoirs", R"([{"name":"lake","line":{"from":[0,0],"to":[0,0.2]},"head":0.5},)"
                        R"({"name":"sea","line":{"from":[0,0.1],"to":[0,0.4]},"head":0.5}])"),
     {"/reservoirs/1/line"}},
    {"SectionOffFaces",
     ADD("/output/sections",
         R"([{"name":"cut","line":{"from":[0.3,0.13],"to":[0.6,0.13]},"quantity":"flow"}])"),
     {"/output/sections/0/line/from", "/output/sections/0/line/to"}},
    {"PlateAbove",
     SET("/loads/0",
         R"({"name":"cover","kind":"plate","body":"sand","plate":{"from":[0.3,0.3],"to":[0.6,0.3]},)"
         R"("plate_velocity":[0,-1]})"),
     {"/loads/0/plate"}},
    {"ProbeInABlock",
     ADD("/output/probes/-", R"({"name":"p","at":[0.25,0.3],"quantity":"head"})"),
     {"/output/probes/2/at"}},
    {"RadiusBelowZero",
     R"([{"op":"add","path":"/domain/dimension","value":"axisymmetric"},{"op":"add","path":"/domain/min","value":[-0.1,0]}])",
     {"/domain/min"}},
    {"PlaneVectorsInSpace",
     R"([{"op":"add","path":"/domain/dimension","value":"space"},{"op":"add","path":"/domain/max","value":[0.6,0.6,0.2]},
         {"op":"add","path":"/bodies","value":[{"name":"sand","kind":"water","region":{"box":{"min":[0,0],"max":[0.1,0.1]}}}]},
         {"op":"remove","path":"/materials/soils"},{"op":"remove","path":"/gravity"},{"op":"remove","path":"/walls"},
         {"op":"remove","path":"/gates"},{"op":"remove","path":"/loads"},{"op":"remove","path":"/stages/0/loads"},
         {"op":"remove","path":"/stages/1/open_gates"},{"op":"remove","path":"/initial"},{"op":"remove","path":"/output"}])",
     {"/bodies/0/region/box/max", "/bodies/0/region/box/min"}},
    {"ProbeOutside", ADD("/output/probes/0/at", "[0.45,-0.1]"), {"/output/probes/0/at"}},
};

const Mutation of_sense[] = {
    {"DilationAboveFriction",
     ADD("/materials/soils/sand/model/dilation_angle", "35"),
     {"/materials/soils/sand/model/dilation_angle"}},
    {"NoStrength",
     R"([{"op":"add","path":"/materials/soils/sand/model/friction_angle","value":0},{"op":"add","path":"/materials/soils/sand/model/dilation_angle","value":0}])",
     {"/materials/soils/sand/model/friction_angle"}},
    {"CutoffAboveTheApex",
     ADD("/materials/soils/sand/model/tension_cutoff", "100"),
     {"/materials/soils/sand/model/tension_cutoff"}},
    {"ResidualAboveCohesion",
     R"([{"op":"add","path":"/materials/soils/sand/model/cohesion","value":100},
         {"op":"add","path":"/materials/soils/sand/model/residual_cohesion","value":200},
         {"op":"add","path":"/materials/soils/sand/model/softening_strain","value":0.1}])",
     {"/materials/soils/sand/model/residual_cohesion"}},
    {"ClayThatSwellsAsMuchAsItCompresses",
     ADD("/materials/soils/sand/model",
         R"({"law":"modified_cam_clay","poisson_ratio":0.2,"compression_slope":0.2,"swelling_slope":0.2,"critical_state_slope":1.1})"),
     {"/materials/soils/sand/model/swelling_slope"}},
    {"ClayWithoutStress",
     R"([{"op":"add","path":"/materials/soils/sand/model","value":{"law":"modified_cam_clay","poisson_ratio":0.2,"compression_slope":0.2,"swelling_slope":0.04,"critical_state_slope":1.1}},
         {"op":"remove","path":"/initial/k0"},{"op":"add","path":"/initial/stress","value":"zero"}])",
     {"/initial/stress"}},
    {"ExplicitPressureInIncompressibleWater",
     R"([{"op":"add","path":"/numerics/pressure","value":"explicit"},{"op":"remove","path":"/numerics/pressure_tolerance"},{"op":"replace","path":"/materials/water/bulk_modulus","value":"incompressible"}])",
     {"/numerics/pressure"}},
    {"SidewaysGravityWithK0", ADD("/gravity", "[1, -9.81]"), {"/initial/stress"}},
    {"MaxPorosityBelowPorosity",
     ADD("/materials/soils/sand/max_porosity", "0.3"),
     {"/materials/soils/sand/max_porosity"}},
    {"UnloadingSofterThanLoading",
     ADD("/materials/soils/sand/model",
         R"({"law":"modified_cam_clay","poisson_ratio":0.2,"compression_slope":0.04,"swelling_slope":0.2,)"
         R"("critical_state_slope":1})"),
     {"/materials/soils/sand/model/swelling_slope"}},
    {"RestAfterTheEnd", ADD("/stages/0/until_rest/at_least", "0.5"), {"/stages/0/until_rest/at_least"}},
    {"TooManyFrames", ADD("/output/frame_interval", "1e-5"), {"/output/frame_interval"}},
    {"TooManySamples", ADD("/output/series_interval", "1e-7"), {"/output/series_interval"}},
    {"HeadWithoutGravity",
     R"([{"op":"add","path":"/gravity","value":[0,0]},{"op":"remove","path":"/output/heave"},{"op":"remove","path":"/initial/k0"}])",
     {"/output/probes/0/quantity", "/output/probes/1/quantity"}},
};

INSTANTIATE_TEST_SUITE_P(Names, CaseSense, testing::ValuesIn(of_names), name_of);
INSTANTIATE_TEST_SUITE_P(Geometry, CaseSense, testing::ValuesIn(of_geometry), name_of);
INSTANTIATE_TEST_SUITE_P(Sense, CaseSense, testing::ValuesIn(of_sense), name_of);

TEST(CaseFaultsTogether, FaultsOfAllKindsComeInOneAnswer) {
  std::string text = patched(R"([
    {"op":"add","path":"/colour","value":"red"},
    {"op":"add","path":"/materials/soils/sand/porosity","value":1.4},
    {"op":"add","path":"/domain/sides/bottom/head","value":1},
    {"op":"add","path":"/stages/1/open_gates/-","value":"door"},
    {"op":"replace","path":"/walls/1/line/to/0","value":0.45},
    {"op":"replace","path":"/bodies/4/region/box/min/1","value":0.23}])");
  text.insert(text.size() - 1, R"(,"name":"again")");  // a duplicate key
  const ParsedCase parsed = parse_case(text);
  const std::vector<std::string> expected{"/bodies/4/region",
                                          "/colour",
                                          "/domain/sides/bottom/head",
                                          "/materials/soils/sand/porosity",
                                          "/name",
                                          "/stages/1/open_gates/1",
                                          "/walls/1/line",
                                          "/walls/1/line/to"};
  EXPECT_EQ(test::pointers(parsed.faults), expected) << test::said(parsed.faults);
}

TEST(CaseFaultsTogether, ConsequencesOfABrokenPartStayUnsaid) {
  // Without the gates nothing can be said about the gates that stages open; the stage's own fault stays.
  const ParsedCase parsed = parse_case(patched(R"([
    {"op":"add","path":"/gates","value":{}}, {"op":"add","path":"/stages/0/until_rest/at_least","value":9}])"));
  EXPECT_EQ(test::pointers(parsed.faults),
            (std::vector<std::string>{"/gates", "/stages/0/until_rest/at_least"}))
      << test::said(parsed.faults);
}

TEST(CaseFaultWords, SayValueRangeAndNearestKey) {
  const auto detail = [](const char* patch) { return parse_case(patched(patch)).faults.at(0).detail; };
  const std::string range = detail(ADD("/materials/soils/sand/porosity", "1.4"));
  EXPECT_NE(range.find("1.4 is not allowed: give a number at least 0.02 and at most 0.95"), std::string::npos)
      << range;
  const std::string unknown = detail(ADD("/materials/soils/sand/porositi", "0.4"));
  EXPECT_NE(unknown.find("did you mean \"porosity\"?"), std::string::npos) << unknown;
  const std::string corner = detail(ADD("/walls/1/line/to", "[0.44,0.513]"));
  EXPECT_NE(corner.find("cells of 0.02 m (cell_size 0.01 × cell_size_factor 2): the nearest is (0.44, 0.52)"),
            std::string::npos)
      << corner;
}

TEST(CaseFaultWords, ManyFaultsAreCutShort) {
  json document = json::parse(test::heave_case());
  for (int k = 0; k < 5000; ++k) document["key" + std::to_string(k)] = k;
  const ParsedCase parsed = parse_case(document.dump());
  ASSERT_EQ(parsed.faults.size(), 1001u);
  EXPECT_NE(parsed.faults.back().detail.find("4000 more"), std::string::npos) << parsed.faults.back().detail;
}

}  // namespace
}  // namespace quicksand
