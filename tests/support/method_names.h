#pragma once

#include "core/settings.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <string>

namespace springtower {

/// The name of a method as a part of a test's name, which may have no hyphens.
inline std::string methodName(const ::testing::TestParamInfo<Method>& info) {
  std::string name(nameOf(info.param));
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

}  // namespace springtower
