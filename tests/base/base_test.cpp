// Errors, parallel loops, progress. (AtomicFiles is tested with the writers.)
#include <gtest/gtest.h>

#include <atomic>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/monitor.h"
#include "base/parallel.h"
#include "base/sha256.h"
#include "base/warning.h"

namespace stackmesh {
namespace {

TEST(Error, IsOneLineThatSaysWhatWhereAndHowToMend) {
  EXPECT_STREQ(Error(ErrorKind::input, "bad", "a.nii", "mend it").what(), "bad, a.nii; mend it");
  EXPECT_STREQ(Error(ErrorKind::input, "bad", "", "mend it").what(), "bad; mend it");
  EXPECT_STREQ(Error(ErrorKind::input, "bad", "a.nii", "").what(), "bad, a.nii");
  EXPECT_STREQ(Error(ErrorKind::input, "bad", "", "").what(), "bad");
  EXPECT_STREQ(Error(ErrorKind::input, "two\nlines", "odd\r\nname", "a\nb").what(), "two lines, odd  name; a b");
}

template <class Action>
ErrorKind kind_of(Action action) {
  try {
    action();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("what, where"), std::string::npos);
    return e.kind();
  }
  ADD_FAILURE() << "nothing was thrown";
  return ErrorKind::internal;
}

TEST(Warning, SaysWhereAndWhatAndEveryCodeHasItsOwnName) {
  const Warning w = warning_at(WarningCode::header, "a.nii", "its unit is not known");
  EXPECT_EQ(w.text, "a.nii: its unit is not known");
  EXPECT_EQ(w.where, "a.nii");
  EXPECT_EQ(texts_of({w, {WarningCode::frame, "", "uncertain"}}),
            (std::vector<std::string>{"a.nii: its unit is not known", "uncertain"}));
  std::set<std::string> names;
  const int count = static_cast<int>(WarningCode::other) + 1;
  for (int code = 0; code < count; ++code) names.insert(to_text(static_cast<WarningCode>(code)));
  EXPECT_EQ(names.size(), static_cast<std::size_t>(count));
}

TEST(Error, KindsAreTheExitCodesOfTheProgram) {
  EXPECT_EQ(static_cast<int>(kind_of([] { fail_usage("what", "where", "mend"); })), 2);
  EXPECT_EQ(static_cast<int>(kind_of([] { fail_input("what", "where", "mend"); })), 3);
  EXPECT_EQ(static_cast<int>(ErrorKind::no_result), 4);
  EXPECT_EQ(static_cast<int>(kind_of([] { fail_output("what", "where", "mend"); })), 5);
  EXPECT_EQ(static_cast<int>(kind_of([] { fail_internal("what", "where"); })), 70);
}

TEST(ParallelFor, CallsEveryIndexOnce) {
  for (std::size_t count : {0, 1, 2, 3, 1000, 50000})
    for (int threads : {0, 1, 2, 7, 64}) {
      std::vector<std::atomic<int>> calls(count);
      parallel_for(count, threads, [&](std::size_t i) { ++calls.at(i); });
      for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(calls[i], 1) << i << " of " << count << ", threads " << threads;
    }
}

TEST(ParallelFor, RethrowsWhatABodyThrows) {
  for (int threads : {1, 2}) {
    std::atomic<int> calls{0};
    try {
      parallel_for(10000, threads, [&](std::size_t i) {
        ++calls;
        if (i == 77) fail_input("bad slice", "slice 77", "");
      });
      ADD_FAILURE() << "nothing was thrown";
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::input);
      EXPECT_STREQ(e.what(), "bad slice, slice 77");
    }
    EXPECT_GE(calls, 1);
    EXPECT_LE(calls, 10000);
  }
}

TEST(ParallelFor, LoopsNest) {
  std::atomic<int> sum{0};
  parallel_for(20, 2,
               [&](std::size_t i) { parallel_for(30, 2, [&](std::size_t j) { sum += static_cast<int>(i * j); }); });
  EXPECT_EQ(sum, 190 * 435);
}

TEST(ParallelFor, IsSilentWhenAskedForMoreThreadsThanThereAre) {
  testing::internal::CaptureStderr();
  parallel_for(1000, 500, [](std::size_t) {});
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(ThreadCount, ZeroIsTheMachine) {
  EXPECT_GE(thread_count(0), 1);
  EXPECT_EQ(thread_count(3), 3);
  EXPECT_EQ(thread_count(-1), thread_count(0));
}

std::string shown(ProgressMode mode) {
  testing::internal::CaptureStderr();  // no terminal
  const auto progress = make_terminal_monitor(mode);
  progress->begin("read");
  for (int i = 0; i <= 100; ++i) progress->advance(i / 100.0);
  progress->end();
  return testing::internal::GetCapturedStderr();
}

TEST(Monitor, PlainIsALineAStageAndTheOthersAreSilentInAPipe) {
  EXPECT_EQ(shown(ProgressMode::none), "");
  EXPECT_EQ(shown(ProgressMode::automatic), "");
  const std::string plain = shown(ProgressMode::plain);
  EXPECT_EQ(plain.rfind("read ", 0), 0U) << plain;
  EXPECT_EQ(std::count(plain.begin(), plain.end(), '\n'), 1) << plain;
  EXPECT_EQ(plain.find('\r'), std::string::npos) << plain;
}

// The vectors of FIPS 180-4, and lengths about the ends of a block fed in pieces.
TEST(Sha256, HasThePublishedDigests) {
  const auto digest = [](const std::string& text) {
    Sha256 s;
    s.add(text);
    return s.hex();
  };
  EXPECT_EQ(digest(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(digest("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(digest("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(digest(std::string(1000000, 'a')), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Sha256, DoesNotDependOnThePieces) {
  for (std::size_t n : {1u, 55u, 56u, 63u, 64u, 65u, 119u, 120u, 128u, 1000u}) {
    std::string text;
    for (std::size_t i = 0; i < n; ++i) text += static_cast<char>(i * 7 + 3);
    Sha256 whole, pieces;
    whole.add(text);
    for (std::size_t i = 0; i < n; i += 13) pieces.add(std::string_view(text).substr(i, 13));
    EXPECT_EQ(whole.hex(), pieces.hex()) << n;
  }
}

}  // namespace
}  // namespace stackmesh
