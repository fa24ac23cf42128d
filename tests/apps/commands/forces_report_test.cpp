#include "core/vector.h"
#include "tests/support/program.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace springtower {
namespace {

using Json = nlohmann::ordered_json;

Json forcesOf(std::vector<std::string> arguments) {
  const ScratchFolder scratch;
  arguments.insert(arguments.begin(), "run");
  arguments.insert(arguments.end(), {"--forces", "--report", scratch.file("report.json")});
  const ProgramResult result = runProgram("springtower", arguments);
  EXPECT_EQ(result.exitCode, 0) << result.error;
  return Json::parse(contentOf(scratch.file("report.json"))).at("forces");
}

Vec3 vectorOf(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

// What is left over on the block that is farthest from balance, and how far the worst contact is outside its cone.
struct Balance {
  double force = 0.0;   // in weights of the block
  double torque = 0.0;  // in its weight times its height
  double outside_n = -1e300;
};

// Adds up the forces of a file: nothing of the program is used but what it wrote.
Balance balanceOf(const Json& forces) {
  const Vec3 gravity = vectorOf(forces.at("gravity_m_s2"));
  const std::size_t count = forces.at("blocks").size();
  std::vector<Vec3> force(count);
  std::vector<Vec3> torque(count, Vec3::Zero());
  std::vector<Vec3> centre(count);
  for (std::size_t b = 0; b < count; ++b) {
    force[b] = forces.at("blocks").at(b).at("mass_kg").get<double>() * gravity;
    centre[b] = vectorOf(forces.at("blocks").at(b).at("centre_m"));
  }
  const auto push = [&](const Json& block, const Vec3& by, const Vec3& place) {
    if (block == "floor") return;
    const auto b = block.get<std::size_t>();
    force[b] += by;
    torque[b] += (place - centre[b]).cross(by);
  };
  for (const Json& user : forces.at("pushes")) push(user.at("block"), vectorOf(user.at("force_n")), vectorOf(user.at("place_m")));
  Balance worst;
  for (const Json& contact : forces.at("contacts")) {
    const auto normal = contact.at("normal_n").get<double>();
    const Vec3 friction = vectorOf(contact.at("friction_n"));
    const Vec3 all = normal * vectorOf(contact.at("normal")) + friction;
    push(contact.at("upper"), all, vectorOf(contact.at("place_on_upper_m")));
    push(contact.at("lower"), -all, vectorOf(contact.at("place_on_lower_m")));
    EXPECT_GT(normal, 0.0) << "contacts push";
    EXPECT_NEAR(vectorOf(contact.at("normal")).norm(), 1.0, 1e-9);
    EXPECT_NEAR(friction.dot(vectorOf(contact.at("normal"))), 0.0, 1e-9);
    const auto coefficient = std::max(forces.at("static_friction").get<double>(), forces.at("kinetic_friction").get<double>());
    worst.outside_n = std::max(worst.outside_n, friction.norm() - coefficient * normal);
  }
  for (std::size_t b = 0; b < count; ++b) {
    const Json& block = forces.at("blocks").at(b);
    const double weight = block.at("mass_kg").get<double>() * gravity.norm();
    EXPECT_GT(block.at("rest_s").get<double>(), 0.0) << "block " << b << " is not at rest";
    const double left = force[b].norm() / weight;
    const double twist = torque[b].norm() / (weight * block.at("height_m").get<double>());
    EXPECT_NEAR(block.at("force_imbalance").get<double>(), left, 1e-9) << "block " << b;
    EXPECT_NEAR(block.at("torque_imbalance").get<double>(), twist, 1e-9) << "block " << b;
    worst.force = std::max(worst.force, left);
    worst.torque = std::max(worst.torque, twist);
  }
  return worst;
}

struct RestingScene {
  std::string name;
  std::vector<std::string> arguments;
};

class ForcesTest : public ::testing::TestWithParam<RestingScene> {};

// A tenth of a per cent of the block's weight, and of its weight times its height.
TEST_P(ForcesTest, BalanceEveryRestingBlockInsideTheCones) {
  const Json forces = forcesOf(GetParam().arguments);
  ASSERT_FALSE(forces.at("contacts").empty());
  const Balance balance = balanceOf(forces);
  EXPECT_LT(balance.force, 1e-3);
  EXPECT_LT(balance.torque, 1e-3);
  EXPECT_LE(balance.outside_n, 1e-9);
  RecordProperty("force", std::to_string(balance.force));
  RecordProperty("torque", std::to_string(balance.torque));
}

INSTANTIATE_TEST_SUITE_P(
    Forces, ForcesTest,
    ::testing::Values(
        RestingScene{"Tower", {"tower:18", "--seconds", "5"}},
        RestingScene{"TowerAwake", {"tower:18", "--seconds", "5", "--no-sleep"}},
        RestingScene{"Uneven", {"tower:9", "--seconds", "6", "--heights-sigma", "0.0002", "--mass-sigma", "0.00185"}},
        // A block that slept before its neighbours rested: what they did to it last is in its balance.
        RestingScene{"UnevenAsleepByTurns",
                     {"tower:9", "--seconds", "8", "--heights-sigma", "0.0002", "--mass-sigma", "0.00185", "--seed", "20"}},
        RestingScene{"LeaningWithALooseBlock", {"(1L1)-(010)-(111)", "--seconds", "5", "--gravity-tilt", "8"}},
        RestingScene{"BySprings", {"tower:4", "--seconds", "4", "--method", "semi-implicit-euler"}}),
    [](const auto& scene) { return scene.param.name; });

// On a slope friction is known: m g sin of the angle, inside the cone of 0.4 (21.8 degrees), along the slope.
TEST(Forces, OfABlockOnASlopeAreThoseOfStatics) {
  const Json forces = forcesOf({"(010)", "--seconds", "3", "--gravity-tilt", "20"});
  double normal = 0.0;
  Vec3 friction = Vec3::Zero();
  for (const Json& contact : forces.at("contacts")) {
    EXPECT_EQ(contact.at("lower"), "floor");
    EXPECT_EQ(contact.at("sliding"), false);
    normal += contact.at("normal_n").get<double>();
    friction += vectorOf(contact.at("friction_n"));
  }
  const double weight = 0.0196 * 9.81;
  EXPECT_NEAR(normal, weight * 0.939693, 1e-4 * weight);
  EXPECT_NEAR(friction.x(), -weight * 0.342020, 1e-4 * weight);
  EXPECT_NEAR(friction.y(), 0.0, 1e-4 * weight);
}

TEST(Forces, NeedAReport) {
  const ProgramResult result = runProgram("springtower", {"run", "(010)", "--forces"});
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_THAT(result.error, ::testing::HasSubstr("--report"));
}

}  // namespace
}  // namespace springtower
