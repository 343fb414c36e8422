#include "server/store.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "server/sha256.hpp"
#include "server/temporary_folder.hpp"

namespace quicksand {
namespace {

constexpr QueueLimits roomy{1000, 1000};

class StoreTest : public testing::Test {
 protected:
  NewRun new_run(const std::string& text, const std::string& key = "", const std::string& label = "") {
    return {text, "name of " + text, label, "0.1.0", key, "", 0, {10, 1e6, 5}};
  }
  std::string queue(const std::string& text) { return store_.create(new_run(text), roomy).run->id; }
  RunState state(const std::string& id) { return store_.find(id)->state; }

  TemporaryFolder folder_;
  Milliseconds now_ = 1'700'000'000'000;
  std::filesystem::path file_ = folder_.path() / "quicksand.db";
  Store store_{file_, [this] { return now_; }};
};

TEST_F(StoreTest, KeepsWhatWasAskedFor) {
  const auto run = store_.create(new_run("{}", "", "nightly"), roomy).run;
  ASSERT_TRUE(run);
  EXPECT_EQ(run->state, RunState::queued);
  EXPECT_EQ(run->name, "name of {}");
  EXPECT_EQ(run->label, "nightly");
  EXPECT_EQ(run->created, now_);
  EXPECT_FALSE(run->started);
  EXPECT_EQ(run->case_sha256, "44136fa355b3678a1146ad16f7e8649e94fb4fc21fe77e8310c060f61caaff8a");
  EXPECT_EQ(store_.case_text(run->id), "{}");
  EXPECT_FALSE(store_.case_text("0000"));
}

TEST_F(StoreTest, RunsInOrderOfSubmission) {
  const std::string first = queue("a"), second = queue("b");
  EXPECT_EQ(store_.claim_next()->id, first);
  EXPECT_EQ(store_.claim_next()->id, second);
  EXPECT_FALSE(store_.claim_next());
}

TEST_F(StoreTest, WalksThroughItsStates) {
  const std::string id = queue("a");
  now_ += 5;
  const auto claimed = store_.claim_next();
  EXPECT_EQ(claimed->state, RunState::running);
  EXPECT_EQ(claimed->started, now_);
  store_.set_progress(id, R"({"fraction":0.5})");
  EXPECT_EQ(store_.find(id)->progress, R"({"fraction":0.5})");
  EXPECT_GT(store_.find(id)->revision, claimed->revision);
  now_ += 5;
  store_.finish(id, RunState::succeeded, {}, {{"result.vtkhdf", 12, "ab"}});
  EXPECT_EQ(state(id), RunState::succeeded);
  EXPECT_EQ(store_.find(id)->finished, now_);
  ASSERT_EQ(store_.results(id).size(), 1u);
  EXPECT_EQ(store_.results(id)[0].bytes, 12u);
}

TEST_F(StoreTest, KeepsTheDiagnosisOfAFailure) {
  const std::string id = queue("a");
  store_.claim_next();
  store_.finish(id, RunState::failed, Failure{"diverged", "too fast", 1.5, {1, 2, 3}}, {});
  const auto failure = store_.find(id)->failure;
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->code, "diverged");
  EXPECT_EQ(failure->message, "too fast");
  EXPECT_EQ(failure->time, 1.5);
  EXPECT_EQ(failure->place[2], 3);
}

TEST_F(StoreTest, ProgressAfterTheEndIsIgnored) {
  const std::string id = queue("a");
  store_.claim_next();
  store_.finish(id, RunState::succeeded, {}, {});
  store_.set_progress(id, "{}");
  EXPECT_EQ(store_.find(id)->progress, "");
}

TEST_F(StoreTest, CancelDependsOnTheState) {
  const std::string running = queue("a"), queued = queue("b");
  store_.claim_next();
  EXPECT_EQ(store_.request_cancel(running)->state, RunState::canceling);
  EXPECT_EQ(store_.request_cancel(running)->state, RunState::canceling);
  EXPECT_EQ(store_.request_cancel(queued)->state, RunState::canceled);
  EXPECT_EQ(store_.request_cancel(queued)->state, RunState::canceled);
  EXPECT_FALSE(store_.request_cancel("0000"));
  EXPECT_FALSE(store_.claim_next());
}

TEST_F(StoreTest, RemovesOnlyWhatHasEnded) {
  const std::string id = queue("a");
  EXPECT_EQ(store_.remove(id), Store::Removal::active);
  store_.claim_next();
  EXPECT_EQ(store_.remove(id), Store::Removal::active);
  store_.finish(id, RunState::succeeded, {}, {{"run.json", 1, "ab"}});
  EXPECT_EQ(store_.remove(id), Store::Removal::removed);
  EXPECT_EQ(store_.remove(id), Store::Removal::unknown);
  EXPECT_TRUE(store_.results(id).empty());
}

TEST_F(StoreTest, SameKeyAndBodyIsTheSameRun) {
  const auto first = store_.create(new_run("a", "key"), roomy);
  const auto again = store_.create(new_run("a", "key"), roomy);
  EXPECT_EQ(again.kind, CreateOutcome::Kind::repeated);
  EXPECT_EQ(again.run->id, first.run->id);
  EXPECT_EQ(store_.create(new_run("b", "key"), roomy).kind, CreateOutcome::Kind::conflict);
  EXPECT_EQ(store_.create(new_run("a", "key", "label"), roomy).kind, CreateOutcome::Kind::conflict);
  EXPECT_EQ(store_.create(new_run("a", "other"), roomy).kind, CreateOutcome::Kind::created);
  EXPECT_EQ(store_.count(RunState::queued), 2);
}

TEST_F(StoreTest, KeysAreForgottenAfterADay) {
  store_.create(new_run("a", "key"), roomy);
  now_ += Store::idempotency_lifetime - 1;
  EXPECT_EQ(store_.create(new_run("b", "key"), roomy).kind, CreateOutcome::Kind::conflict);
  now_ += 1;
  EXPECT_EQ(store_.create(new_run("b", "key"), roomy).kind, CreateOutcome::Kind::created);
}

TEST_F(StoreTest, AFullQueueRefuses) {
  queue("a");
  EXPECT_EQ(store_.create(new_run("b"), {1, 1000}).kind, CreateOutcome::Kind::full);
  EXPECT_EQ(store_.count(RunState::queued), 1);
}

TEST_F(StoreTest, ListsNewestFirstAndFilters) {
  const std::string a = queue("a");
  now_ += 1000;
  const std::string b = store_.create(new_run("b", "", "tagged"), roomy).run->id;
  const auto ids = [&](const RunFilter& filter) {
    std::vector<std::string> found;
    for (const StoredRun& run : store_.list(filter)) found.push_back(run.id);
    return found;
  };
  using Ids = std::vector<std::string>;
  RunFilter filter;
  EXPECT_EQ(ids(filter), (Ids{b, a}));
  filter.limit = 1;
  EXPECT_EQ(ids(filter), (Ids{b}));
  filter.before_sequence = store_.find(b)->sequence;
  EXPECT_EQ(ids(filter), (Ids{a}));
  filter = {};
  filter.label = "tagged";
  EXPECT_EQ(ids(filter), (Ids{b}));
  filter = {};
  filter.name_prefix = "name of a";
  EXPECT_EQ(ids(filter), (Ids{a}));
  filter.name_prefix = "name%";  // no wildcards
  EXPECT_EQ(ids(filter), (Ids{}));
  filter = {};
  filter.created_after = now_ - 1;
  EXPECT_EQ(ids(filter), (Ids{b}));
  filter = {};
  filter.state = RunState::running;
  EXPECT_EQ(ids(filter), (Ids{}));
}

TEST_F(StoreTest, RecoversWhatAKillLeftBehind) {
  const std::string running = queue("a"), canceling = queue("b"), queued = queue("c");
  store_.claim_next();
  store_.claim_next();
  store_.set_progress(running, "{}");
  store_.request_cancel(canceling);

  Store restarted(file_, [this] { return now_; });
  const auto standing_still = [](const StoredRun&) { return false; };
  const Recovery first = restarted.recover(standing_still);
  EXPECT_EQ(first.requeued, std::vector<std::string>{running});
  EXPECT_EQ(first.canceled, std::vector<std::string>{canceling});
  EXPECT_EQ(state(running), RunState::queued);
  EXPECT_EQ(store_.find(running)->progress, "");
  EXPECT_FALSE(store_.find(running)->started);
  EXPECT_EQ(state(canceling), RunState::canceled);
  EXPECT_EQ(state(queued), RunState::queued);

  for (int retries = 1; retries < Store::most_fruitless - 1; ++retries) {
    EXPECT_EQ(store_.find(running)->retries, retries);
    EXPECT_EQ(restarted.claim_next()->id, running);
    EXPECT_EQ(restarted.recover(standing_still).requeued, std::vector<std::string>{running});
  }
  EXPECT_EQ(restarted.claim_next()->id, running);
  EXPECT_EQ(restarted.recover(standing_still).interrupted, std::vector<std::string>{running});
  EXPECT_EQ(state(running), RunState::failed);
  EXPECT_EQ(store_.find(running)->failure->code, "interrupted");
}

TEST_F(StoreTest, ARunThatGetsFurtherIsNeverGivenUp) {
  const std::string running = queue("a");
  for (int i = 0; i < 3 * Store::most_fruitless; ++i) {
    store_.claim_next();
    EXPECT_EQ(store_.recover([](const StoredRun&) { return true; }).requeued,
              std::vector<std::string>{running});
    EXPECT_EQ(store_.find(running)->retries, 1);
  }
}

TEST_F(StoreTest, AnOrderlyStopCostsNoRetry) {
  const std::string id = queue("a");
  store_.claim_next();
  store_.requeue(id);
  EXPECT_EQ(state(id), RunState::queued);
  EXPECT_EQ(store_.find(id)->retries, 0);
}

TEST_F(StoreTest, ARunThatWaitsForTheDiskSaysSoUntilItGoesOn) {
  const std::string id = queue("a");
  store_.claim_next();
  store_.requeue(id, Failure{"disk_full", "the disk is full", 2, {}});
  EXPECT_EQ(state(id), RunState::queued);
  EXPECT_EQ(store_.find(id)->failure->code, "disk_full");
  EXPECT_EQ(store_.find(id)->failure->time, 2);
  EXPECT_FALSE(store_.claim_next()->failure);
  store_.requeue(id, Failure{"read_only", "", 0, {}});
  store_.request_cancel(id);
  EXPECT_EQ(state(id), RunState::canceled);
  EXPECT_FALSE(store_.find(id)->failure);
}

TEST_F(StoreTest, ResultsCanBeAddedToAnEndedRun) {
  const std::string id = queue("a");
  store_.add_results(id, {{"run.json", 3, "abc"}});  // not yet
  EXPECT_TRUE(store_.results(id).empty());
  store_.request_cancel(id);
  const long long revision = store_.find(id)->revision;
  store_.add_results(id, {{"run.json", 3, "abc"}});
  EXPECT_EQ(store_.results(id).size(), 1U);
  EXPECT_GT(store_.find(id)->revision, revision);
}

TEST_F(StoreTest, ACanceledRunIsNotQueuedAgain) {
  const std::string id = queue("a");
  store_.claim_next();
  store_.request_cancel(id);
  store_.requeue(id);
  EXPECT_EQ(state(id), RunState::canceling);
}

TEST_F(StoreTest, RefusesTheFileOfANewerVersion) {
  {
    SQLite::Database database(file_.string(), SQLite::OPEN_READWRITE);
    database.exec("PRAGMA user_version = 99");
  }
  EXPECT_THROW(Store{file_}, std::runtime_error);
}

TEST_F(StoreTest, HigherPrioritiesGoFirst) {
  const std::string plain = queue("a");
  NewRun urgent = new_run("b"), idle = new_run("c");
  urgent.priority = 1;
  idle.priority = -1;
  const std::string low = store_.create(idle, roomy).run->id, high = store_.create(urgent, roomy).run->id;
  EXPECT_EQ(store_.claim_next()->id, high);
  EXPECT_EQ(store_.claim_next()->id, plain);
  EXPECT_EQ(store_.claim_next()->id, low);
}

TEST_F(StoreTest, OwnersTakeTurns) {
  const auto queue_for = [&](const std::string& owner) {
    NewRun run = new_run(owner);
    run.owner = owner;
    return store_.create(run, roomy).run->id;
  };
  std::vector<std::string> order;
  for (int i = 0; i < 3; ++i) queue_for("anna");
  queue_for("ben");
  queue_for("ben");
  for (int i = 0; i < 5; ++i) {
    now_ += 1000;
    order.push_back(store_.claim_next()->owner);
  }
  EXPECT_EQ(order, (std::vector<std::string>{"anna", "ben", "anna", "ben", "anna"}));
}

TEST_F(StoreTest, AWorkerForShortRunsLeavesLongOnes) {
  NewRun run = new_run("a");
  run.cost.seconds = 100;
  const std::string slow = store_.create(run, roomy).run->id;
  ClaimRules only_short;
  only_short.longest_s = 99;
  EXPECT_FALSE(store_.claim_next(only_short));
  const std::string quick = queue("b");
  EXPECT_EQ(store_.claim_next(only_short)->id, quick);
  EXPECT_EQ(store_.claim_next()->id, slow);
}

TEST_F(StoreTest, WhoDoesNotFitIsNotOvertaken) {
  NewRun run = new_run("a");
  run.cost.memory_bytes = 3e6;
  const std::string large = store_.create(run, roomy).run->id;
  queue("b");
  EXPECT_FALSE(store_.claim_next({2e6}));
  EXPECT_EQ(store_.claim_next({3e6})->id, large);
}

TEST_F(StoreTest, AnOwnerHasOnlySoManyActiveRuns) {
  NewRun run = new_run("a");
  run.owner = "anna";
  const std::string id = store_.create(run, {1000, 1}).run->id;
  EXPECT_EQ(store_.create(run, {1000, 1}).kind, CreateOutcome::Kind::over_quota);
  store_.claim_next();
  EXPECT_EQ(store_.create(run, {1000, 1}).kind, CreateOutcome::Kind::over_quota);
  run.owner = "ben";
  EXPECT_EQ(store_.create(run, {1000, 1}).kind, CreateOutcome::Kind::created);
  store_.finish(id, RunState::succeeded, {}, {});
  run.owner = "anna";
  EXPECT_EQ(store_.create(run, {1000, 1}).kind, CreateOutcome::Kind::created);
}

TEST_F(StoreTest, IdempotencyKeysAreOnesOwn) {
  NewRun run = new_run("a", "key");
  run.owner = "anna";
  const std::string hers = store_.create(run, roomy).run->id;
  run.owner = "ben";
  const auto his = store_.create(run, roomy);
  EXPECT_EQ(his.kind, CreateOutcome::Kind::created);
  EXPECT_NE(his.run->id, hers);
}

TEST_F(StoreTest, OldResultsExpireAndTheRecordSaysSo) {
  const std::string old = queue("a"), active = queue("b");
  store_.claim_next();
  store_.finish(old, RunState::succeeded, {}, {{"run.json", 7, "ab"}});
  EXPECT_EQ(store_.results_bytes(), 7);
  EXPECT_TRUE(store_.expire(now_).empty());
  now_ += 1000;
  EXPECT_EQ(store_.expire(now_), std::vector<std::string>{old});
  EXPECT_TRUE(store_.expire(now_).empty());
  EXPECT_EQ(store_.find(old)->expired, now_);
  EXPECT_EQ(store_.find(old)->state, RunState::succeeded);
  EXPECT_TRUE(store_.results(old).empty());
  EXPECT_EQ(store_.results_bytes(), 0);
  EXPECT_EQ(store_.expired(), std::vector<std::string>{old});
  EXPECT_FALSE(store_.find(active)->expired);
}

TEST_F(StoreTest, ManyThreadsLoseNothing) {
  constexpr int threads = 4, each = 25;
  std::vector<std::thread> writers;
  for (int t = 0; t < threads; ++t)
    writers.emplace_back([&, t] {
      Store own(file_);  // as another process would
      for (int i = 0; i < each; ++i) own.create(new_run(std::to_string(t * each + i)), roomy);
    });
  for (std::thread& writer : writers) writer.join();
  EXPECT_EQ(store_.count(RunState::queued), threads * each);
}

TEST(Sha256, MatchesThePublishedVector) {  // FIPS 180-2, appendix B.1
  EXPECT_EQ(sha256_text("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(ClockTest, WritesAndReadsRfc3339) {
  EXPECT_EQ(rfc3339(0), "1970-01-01T00:00:00.000Z");
  EXPECT_EQ(rfc3339(1'700'000'000'042), "2023-11-14T22:13:20.042Z");
  EXPECT_EQ(parse_rfc3339("2023-11-14T22:13:20.042Z"), 1'700'000'000'042);
  EXPECT_EQ(parse_rfc3339("2023-11-14T22:13:20Z"), 1'700'000'000'000);
  for (const std::string& wrong :
       {std::string(), std::string("2023-11-14"), std::string("2023-11-14T22:13:20"),
        std::string("2023-11-14T22:13:20Zx"), std::string("2023-11-14T22:13:20Z\0", 21),
        std::string("1969-12-31T23:59:59Z"), std::string("yesterday")})
    EXPECT_FALSE(parse_rfc3339(wrong)) << wrong;
}

}  // namespace
}  // namespace quicksand
