#include "server/keys.hpp"

#include <gtest/gtest.h>

#include "server/access.hpp"
#include "server/http_problem.hpp"
#include "server/store.hpp"
#include "server/temporary_folder.hpp"

namespace quicksand {
namespace {

class KeysTest : public testing::Test {
 protected:
  int status(const std::string& key, Access access, const std::string& host = "localhost") {
    httplib::Request request;
    request.headers = {{"Host", host}};
    if (!key.empty()) request.headers.emplace("X-API-Key", key);
    try {
      admit(keys_, settings_, request, access);
      return 200;
    } catch (const ProblemError& error) {
      return error.problem.status;
    }
  }

  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "quicksand.db";
  Store store_{file_};
  KeyStore keys_{file_};
  Settings settings_;
};

TEST_F(KeysTest, AKeyIsFoundByItsWholeTextOnly) {
  const std::string text = keys_.create("anna", Role::submit);
  const auto key = keys_.find(text);
  ASSERT_TRUE(key);
  EXPECT_EQ(key->name, "anna");
  EXPECT_EQ(key->role, Role::submit);
  EXPECT_FALSE(keys_.find(""));
  EXPECT_FALSE(keys_.find(key->id));
  EXPECT_FALSE(keys_.find("qs_" + key->id));
  EXPECT_FALSE(keys_.find("qs_" + key->id + "_"));
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::string wrong = text;
    wrong[i] = wrong[i] == 'x' ? 'y' : 'x';
    EXPECT_FALSE(keys_.find(wrong)) << i;
  }
}

TEST_F(KeysTest, TwoKeysOfOneNameAreTwoSecrets) {
  EXPECT_NE(keys_.create("anna", Role::submit), keys_.create("anna", Role::submit));
  EXPECT_EQ(keys_.list().size(), 2u);
}

TEST_F(KeysTest, RevokingKeepsTheFirstTime) {
  const std::string text = keys_.create("anna", Role::read);
  const std::string id = keys_.list()[0].id;
  EXPECT_TRUE(keys_.revoke(id));
  const auto revoked = keys_.list()[0].revoked;
  ASSERT_TRUE(revoked);
  EXPECT_TRUE(keys_.revoke(id));
  EXPECT_EQ(keys_.list()[0].revoked, revoked);
  EXPECT_FALSE(keys_.find(text));
  EXPECT_FALSE(keys_.revoke("nobody"));
  EXPECT_TRUE(keys_.any());
}

TEST_F(KeysTest, WithoutKeysThisMachineOnly) {
  for (const Access access : {Access::anyone, Access::known, Access::change, Access::observe})
    EXPECT_EQ(status("", access), 200);
  EXPECT_EQ(status("", Access::known, "lab.example"), 421);
  EXPECT_EQ(status("", Access::anyone, "lab.example"), 200);  // supervisors may call it as they like
  settings_.host = "0.0.0.0";
  EXPECT_EQ(status("", Access::known), 401);
}

TEST_F(KeysTest, RolesGiveWhatTheySay) {
  const std::string read = keys_.create("r", Role::read), submit = keys_.create("s", Role::submit),
                    admin = keys_.create("a", Role::admin);
  struct Row {
    Access access;
    int none, read, submit, admin;
  };
  for (const Row& row : {Row{Access::anyone, 200, 200, 200, 200}, Row{Access::known, 401, 200, 200, 200},
                         Row{Access::change, 401, 403, 200, 200}, Row{Access::observe, 401, 200, 403, 200}}) {
    EXPECT_EQ(status("", row.access), row.none);
    EXPECT_EQ(status(read, row.access), row.read);
    EXPECT_EQ(status(submit, row.access), row.submit);
    EXPECT_EQ(status(admin, row.access), row.admin);
  }
}

TEST_F(KeysTest, OnlyASubmittersSightIsNarrow) {
  EXPECT_TRUE((Caller{"anna", Role::submit}.sees("anna")));
  EXPECT_FALSE((Caller{"anna", Role::submit}.sees("ben")));
  EXPECT_FALSE((Caller{"anna", Role::submit}.sees("")));
  EXPECT_TRUE((Caller{"anna", Role::read}.sees("ben")));
  EXPECT_TRUE((Caller{"anna", Role::admin}.sees("ben")));
}

}  // namespace
}  // namespace quicksand
