#include "server/http_server.hpp"

#include <gtest/gtest.h>

namespace quicksand {
namespace {

/// A request that passes, to be spoilt by each test.
httplib::Request good_request() {
  httplib::Request request;
  request.method = "POST";
  request.path = "/v1/runs";
  request.headers = {{"Content-Length", "2"}, {"Content-Type", "application/json; charset=utf-8"}};
  return request;
}

int status_of(const httplib::Request& request) {
  const auto refused = screen_request(request, Settings{});
  return refused ? refused->status : 0;
}

TEST(ScreenRequest, LetsAGoodRequestPass) { EXPECT_EQ(status_of(good_request()), 0); }

TEST(ScreenRequest, RefusesOddFraming) {
  auto chunked = good_request();
  chunked.headers.emplace("Transfer-Encoding", "chunked");
  EXPECT_EQ(status_of(chunked), 411);
  auto packed = good_request();
  packed.headers.emplace("Content-Encoding", "gzip");
  EXPECT_EQ(status_of(packed), 415);
  auto twice = good_request();
  twice.headers.emplace("Content-Length", "2");
  EXPECT_EQ(status_of(twice), 400);
  auto missing = good_request();
  missing.headers.erase("Content-Length");
  EXPECT_EQ(status_of(missing), 411);
  for (const char* length : {"", "abc", "-1", "+2", "2 ", "2,2", "0x2", "99999999999999999999999"}) {
    auto odd = good_request();
    odd.headers.erase("Content-Length");
    odd.headers.emplace("Content-Length", length);
    EXPECT_EQ(status_of(odd), 400) << length;
  }
}

TEST(ScreenRequest, RefusesWhatIsTooLargeByOneByte) {
  auto request = good_request();
  request.headers.erase("Content-Length");
  request.headers.emplace("Content-Length", std::to_string(Settings{}.max_body_bytes));
  EXPECT_EQ(status_of(request), 0);
  request.headers.erase("Content-Length");
  request.headers.emplace("Content-Length", std::to_string(Settings{}.max_body_bytes + 1));
  EXPECT_EQ(status_of(request), 413);
}

TEST(ScreenRequest, WantsJsonWhereACaseIsTaken) {
  for (const char* type : {"text/plain", "application/x-www-form-urlencoded", "application/jsonx", ""}) {
    auto request = good_request();
    request.headers.erase("Content-Type");
    request.headers.emplace("Content-Type", type);
    EXPECT_EQ(status_of(request), 415) << type;
    request.path = "/v1/runs/abc/cancel";
    EXPECT_EQ(status_of(request), 0) << type;
  }
}

}  // namespace
}  // namespace quicksand
