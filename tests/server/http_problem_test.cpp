#include "server/http_problem.hpp"

#include <gtest/gtest.h>

#include "server/run_json.hpp"

namespace quicksand {
namespace {

TEST(ProblemJson, CarriesEveryFault) {
  Problem problem;
  problem.status = 422;
  problem.detail = "the case cannot be run";
  problem.errors = {{"/a", "wrong"}, {"/b/0", "missing"}};
  const Json json = Json::parse(problem_json(problem));
  EXPECT_EQ(json.at("status"), 422);
  EXPECT_EQ(json.at("type"), "about:blank");
  EXPECT_EQ(json.at("title"), "Unprocessable content");
  ASSERT_EQ(json.at("errors").size(), 2u);
  EXPECT_EQ(json["errors"][1]["pointer"], "/b/0");
  EXPECT_EQ(json["errors"][1]["detail"], "missing");
}

TEST(ProblemJson, AnInternalErrorTellsNothing) {
  const Json json = Json::parse(problem_json(Problem{}));
  EXPECT_EQ(json.at("status"), 500);
  EXPECT_FALSE(json.contains("detail"));
  EXPECT_FALSE(json.contains("errors"));
}

TEST(ProblemJson, SurvivesBytesThatAreNotUtf8) {
  Problem problem;
  problem.detail = "nothing at /\xff";
  EXPECT_TRUE(Json::accept(problem_json(problem)));
}

TEST(Answer, SetsTheHeadersOfTheStatus) {
  Problem problem;
  problem.status = 405;
  problem.allow = "GET, HEAD";
  httplib::Response refused;
  answer(refused, problem);
  EXPECT_EQ(refused.status, 405);
  EXPECT_EQ(refused.get_header_value("Allow"), "GET, HEAD");
  EXPECT_EQ(refused.get_header_value("Content-Type"), "application/problem+json");

  problem = {};
  problem.status = 503;
  problem.retry_after_s = 7;
  httplib::Response full;
  answer(full, problem);
  EXPECT_EQ(full.get_header_value("Retry-After"), "7");
}

}  // namespace
}  // namespace quicksand
