#include "core/method.h"

#include <gtest/gtest.h>

namespace springtower {
namespace {

TEST(MethodTraits, EveryMethodIsOfTheFamilyThatItsNameSays) {
  for (const Method method : {Method::implicit, Method::implicitEuler, Method::implicitEigen}) EXPECT_TRUE(isImplicit(method));
  for (const Method method : {Method::rigidPgs, Method::rigidLcp, Method::xpbd}) EXPECT_TRUE(isRigid(method));
  for (const Method method : {Method::semiImplicitEuler, Method::midpoint, Method::rungeKutta4})
    EXPECT_EQ(traitsOf(method).family, MethodFamily::explicitSprings);
  EXPECT_EQ(traitsOf(Method::report).family, MethodFamily::report);
}

TEST(MethodTraits, OnlyExplicitMethodsHaveALargestStep) {
  for (const Method method : {Method::semiImplicitEuler, Method::midpoint, Method::rungeKutta4, Method::report})
    EXPECT_FALSE(isStableForAnyStep(method));
  for (const Method method : {Method::implicit, Method::rigidPgs, Method::xpbd}) EXPECT_TRUE(isStableForAnyStep(method));
}

}  // namespace
}  // namespace springtower
