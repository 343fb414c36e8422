#include "server/routes.hpp"

#include <gtest/gtest.h>

#include "api/openapi.hpp"

namespace quicksand {
namespace {

TEST(FindRoute, CapturesSegments) {
  const RouteMatch match = find_route("GET", "/v1/runs/abc/results/run.json");
  ASSERT_NE(match.route, nullptr);
  EXPECT_EQ(match.captured, (std::vector<std::string>{"abc", "run.json"}));
}

TEST(FindRoute, HeadIsGet) {
  ASSERT_NE(find_route("HEAD", "/healthz").route, nullptr);
  EXPECT_STREQ(find_route("HEAD", "/healthz").route->pattern, "/healthz");
}

TEST(FindRoute, AWrongMethodLearnsTheRightOnes) {
  EXPECT_EQ(find_route("PUT", "/v1/runs").route, nullptr);
  EXPECT_EQ(find_route("PUT", "/v1/runs").allow, "GET, HEAD, POST");
  EXPECT_EQ(find_route("GET", "/v1/runs/abc/cancel").allow, "POST");
}

TEST(FindRoute, UnknownPathsHaveNoMethods) {
  for (const char* path :
       {"/", "/v1", "/v1/runs/", "/v1/runs//case", "/v1/runs/a/b/c/d", "v1/runs", "/v1/runs/a/results/b/c"}) {
    EXPECT_EQ(find_route("GET", path).route, nullptr) << path;
    EXPECT_EQ(find_route("GET", path).allow, "") << path;
  }
}

TEST(RouteTable, IsWhatTheDocumentDescribes) {
  const std::string document = openapi_document();
  for (const Route& route : route_table())
    EXPECT_NE(document.find(std::string("\n  ") + route.pattern + ":\n"), std::string::npos) << route.pattern;
}

}  // namespace
}  // namespace quicksand
