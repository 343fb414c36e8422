// Databases of earlier versions, made from the schema as it was released then.

#include <SQLiteCpp/Statement.h>
#include <gtest/gtest.h>

#include "server/files.hpp"
#include "server/keys.hpp"
#include "server/sha256.hpp"
#include "server/store.hpp"
#include "server/temporary_folder.hpp"

namespace quicksand {
namespace {

class MigrationTest : public testing::Test {
 protected:
  MigrationTest() {
    SQLite::Database old(file_.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    old.exec(read_text(SCHEMA_1).value());
    old.exec(R"sql(
INSERT INTO runs (id, state, name, label, case_text, case_sha256, engine_version, created, finished, retries)
  VALUES ('aa', 'succeeded', 'one', 'tag', '{}', 'ff', '0.1.0', 1000, 2000, 1);
INSERT INTO runs (id, state, name, label, case_text, case_sha256, engine_version, created)
  VALUES ('bb', 'queued', 'two', '', '{}', 'ff', '0.1.0', 1001);
INSERT INTO results VALUES ('aa', 'run.json', 7, 'ee');
INSERT INTO idempotency_keys VALUES ('night', 'dd', 'bb', 1001);
)sql");
  }

  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "quicksand.db";
};

TEST_F(MigrationTest, NothingIsLostFromVersion1) {
  Store store(file_, [] { return Milliseconds{5000}; });
  const auto done = store.find("aa");
  ASSERT_TRUE(done);
  EXPECT_EQ(done->state, RunState::succeeded);
  EXPECT_EQ(done->label, "tag");
  EXPECT_EQ(done->finished, 2000);
  EXPECT_EQ(done->retries, 1);
  EXPECT_EQ(done->owner, "");
  EXPECT_FALSE(done->expired);
  EXPECT_EQ(done->kind, RunKind::run);
  EXPECT_EQ(done->budget, 0);
  ASSERT_EQ(store.results("aa").size(), 1u);
  EXPECT_EQ(store.results("aa")[0].bytes, 7u);
  const std::string same = sha256_text(sha256_text("{}"));  // as version 1 kept the body of a key
  SQLite::Database(file_.string(), SQLite::OPEN_READWRITE)
      .exec("UPDATE idempotency_keys SET created = 4000, request_sha256 = '" + same + "'");
  EXPECT_EQ(store.create({"{}", "two", "", "0.1.0", "night", "", 0, {}}, {10, 10}).kind,
            CreateOutcome::Kind::repeated);
  NewRun again{"other", "two", "", "0.1.0", "night", "", 0, {}};
  EXPECT_EQ(store.create(again, {10, 10}).kind, CreateOutcome::Kind::conflict);
}

TEST_F(MigrationTest, WhatWaitedIsPlannedAndClaimed) {
  Store store(file_);
  ASSERT_EQ(store.queued().size(), 1u);
  EXPECT_EQ(store.queued()[0].cost.points, 0);
  store.set_cost("bb", {10, 2e6, 30});
  EXPECT_EQ(store.queued()[0].cost.points, 10);
  EXPECT_FALSE(store.claim_next({1e6}));
  EXPECT_EQ(store.claim_next({3e6})->id, "bb");
}

TEST_F(MigrationTest, ASecondOpeningChangesNothing) {
  { Store store(file_); }
  Store store(file_);
  EXPECT_TRUE(store.find("aa"));
}

TEST_F(MigrationTest, KeysWaitForTheServerToMigrate) {
  EXPECT_THROW(KeyStore{file_}, std::runtime_error);
  { Store store(file_); }
  EXPECT_NO_THROW(KeyStore{file_});
}

TEST_F(MigrationTest, AStepThatFailsLeavesTheOldVersion) {
  {
    SQLite::Database old(file_.string(), SQLite::OPEN_READWRITE);
    old.exec("CREATE TABLE api_keys (x)");  // in the way of version 2
  }
  EXPECT_THROW(Store{file_}, SQLite::Exception);
  SQLite::Database old(file_.string(), SQLite::OPEN_READONLY);
  EXPECT_EQ(old.execAndGet("PRAGMA user_version").getInt(), 1);
  EXPECT_EQ(old.execAndGet("SELECT COUNT(*) FROM pragma_table_info('runs') WHERE name = 'owner'").getInt(),
            0);
}

}  // namespace
}  // namespace quicksand
