#pragma once

#include "core/version.h"
#include "tests/support/program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace springtower {

/// Whether a run went on with the results that an earlier one of this build left. A build with uncommitted changes has to refuse
/// them with exit code 2, as its commit does not say what it was made of; both are expected here.
inline bool wentOn(const ProgramResult& again) {
  const bool isDirty = kGitCommit.ends_with("-dirty");
  EXPECT_EQ(again.exitCode, isDirty ? 2 : 0) << again.error;
  EXPECT_THAT(again.error, ::testing::HasSubstr(isDirty ? "this build has uncommitted changes" : ""));
  return again.exitCode == 0;
}

}  // namespace springtower
