#include "apps/viewer/view/colours.h"

#include "tests/apps/commands/loose_tower.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace springtower {
namespace {

double linear(double value) {
  return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

// What eyes without one of the three cones see of linear red, green and blue: none missing, then red, green, blue ones (Machado
// et al. 2009, severity 1).
std::vector<Eigen::Matrix3d> eyes() {
  std::vector<Eigen::Matrix3d> all(4, Eigen::Matrix3d::Identity());
  all[1] << 0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998;
  all[2] << 0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.011820, 0.042940, 0.968881;
  all[3] << 1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602, 0.004733, 0.691367, 0.303900;
  return all;
}

// CIE L*a*b* under D65.
Eigen::Vector3d labOf(const Colour& colour, const Eigen::Matrix3d& eye) {
  Eigen::Vector3d rgb;
  for (int a = 0; a < 3; ++a) rgb[a] = linear(static_cast<double>(colour[static_cast<std::size_t>(a)]));
  rgb = (eye * rgb).cwiseMax(0.0).cwiseMin(1.0);
  Eigen::Matrix3d toXyz;
  toXyz << 0.4124564, 0.3575761, 0.1804375, 0.2126729, 0.7151522, 0.0721750, 0.0193339, 0.1191920, 0.9503041;
  const Eigen::Vector3d xyz = (toXyz * rgb).cwiseQuotient(Eigen::Vector3d(0.95047, 1.0, 1.08883));
  const auto f = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116.0; };
  return {116.0 * f(xyz.y()) - 16.0, 500.0 * (f(xyz.x()) - f(xyz.y())), 200.0 * (f(xyz.y()) - f(xyz.z()))};
}

double difference(const Colour& a, const Colour& b, const Eigen::Matrix3d& eye) {
  return (labOf(a, eye) - labOf(b, eye)).norm();
}

constexpr double kApart = 20.0;  // of L*a*b*, in which 2 can just be seen: clearly another colour

// Brightness alone gives the place of a colour on its scale.
TEST(ViewerColours, ScalesGoOneWayInBrightnessForAllEyes) {
  for (const Eigen::Matrix3d& eye : eyes()) {
    for (const Overlay overlay : {Overlay::load, Overlay::strain, Overlay::hints}) {
      const double sign = overlay == Overlay::hints ? -1.0 : 1.0;
      double before = labOf(colourMap(overlay, 0.0), eye).x();
      for (int i = 1; i <= 10; ++i) {
        const double now = labOf(colourMap(overlay, 0.1 * i), eye).x();
        EXPECT_GT(sign * (now - before), 2.0) << static_cast<int>(overlay) << ", step " << i;
        before = now;
      }
    }
  }
}

TEST(ViewerColours, LooseBlocksStandApartFromAllOthersForAllEyes) {
  for (const Eigen::Matrix3d& eye : eyes()) {
    for (int i = 0; i <= 20; ++i) EXPECT_GT(difference(kLooseColour, colourMap(Overlay::hints, 0.05 * i), eye), kApart) << i;
  }
}

TEST(ViewerColours, OppositesStandApartForAllEyes) {
  for (const Eigen::Matrix3d& eye : eyes()) {
    EXPECT_GT(difference(holdColour(Hold::sticks), holdColour(Hold::slips), eye), kApart);
    EXPECT_GT(difference(marginColour(0.0), marginColour(1.0), eye), kApart);
  }
}

TEST(ViewerColours, LoadAndStrainAreTwoScales) {
  for (const Eigen::Matrix3d& eye : eyes()) {
    double most = 0.0;
    for (int i = 0; i <= 10; ++i)
      most = std::max(most, difference(colourMap(Overlay::load, 0.1 * i), colourMap(Overlay::strain, 0.1 * i), eye));
    EXPECT_GT(most, kApart);
  }
}

TEST(ViewerColours, EveryOverlayButWoodHasALegend) {
  const Session session(bitCodeScene(kLooseTower));
  for (std::size_t i = 0; i < kOverlays; ++i) {
    const auto overlay = static_cast<Overlay>(i);
    const BlockColours colours = blockColours(session, overlay);
    EXPECT_EQ(legendOf(overlay, colours, false).empty(), overlay == Overlay::wood) << i;
    EXPECT_EQ(legendOf(overlay, colours, true).size(), legendOf(overlay, colours, false).size() + 2) << i;
  }
}

}  // namespace
}  // namespace springtower
