#include "core/settings.h"

#include "core/error.h"

#include <gmock/gmock.h>
#include <limits>
#include <set>

namespace springtower {
namespace {

using testing::ThrowsMessage;

TEST(Settings, DefaultsAreWithinTheirOwnLimits) {
  EXPECT_NO_THROW(checkSettings(Settings{}, "defaults"));
}

TEST(Settings, EveryRowNamesAnotherSettingAndGivesAReason) {
  std::set<std::string_view> keys;
  for (const SettingRow& row : settingTable()) {
    EXPECT_TRUE(keys.insert(row.key).second) << row.key;
    EXPECT_FALSE(row.reason.empty()) << row.key;
    EXPECT_LT(row.least, row.most) << row.key;
    const bool saysSeconds = row.key.ends_with("_s");
    const bool saysMetres = row.key.ends_with("_m");
    EXPECT_EQ(saysSeconds, row.unit == "s") << row.key;
    EXPECT_EQ(saysMetres, row.unit == "m") << row.key;
  }
  std::set<const void*> members;
  Settings settings;
  for (const SettingRow& row : settingTable()) {
    std::visit([&](auto member) { EXPECT_TRUE(members.insert(&(settings.*member)).second) << row.key; }, row.member);
  }
}

TEST(Settings, EachNumberIsHeldToBothEndsOfItsRange) {
  for (const SettingRow& row : settingTable()) {
    if (std::holds_alternative<int Settings::*>(row.member) || std::holds_alternative<bool Settings::*>(row.member)) continue;
    Settings settings;
    const auto set = [&](double value) {
      if (const auto* number = std::get_if<double Settings::*>(&row.member)) settings.** number = value;
      if (const auto* optional = std::get_if<std::optional<double> Settings::*>(&row.member)) settings.** optional = value;
    };
    for (const double end : {row.least, row.most}) {
      set(end);
      EXPECT_NO_THROW(checkSettings(settings, "test")) << row.key;
    }
    const double infinity = std::numeric_limits<double>::infinity();
    for (const double bad : {row.least - 1e-3, row.most + 1e-3, infinity, std::numeric_limits<double>::quiet_NaN()}) {
      set(bad);
      EXPECT_THROW(checkSettings(settings, "test"), InputError) << row.key << " = " << bad;
    }
  }
}

TEST(Settings, ComplaintNamesSourceKeyFoundAndAllowed) {
  Settings settings;
  settings.stabilitySafety = 1.5;
  EXPECT_THAT([&] { checkSettings(settings, "command line"); },
              ThrowsMessage<InputError>("command line: stability_safety: expected 0.05 to 1, got 1.5"));
  settings = {};
  settings.tolerance_m = -1e-5;
  EXPECT_THAT([&] { checkSettings(settings, "command line"); },
              ThrowsMessage<InputError>("command line: tolerance_m: expected 1e-07 to 0.01 m, got -1e-05"));
  settings = {};
  settings.substeps = -1;
  EXPECT_THAT([&] { checkSettings(settings, "command line"); },
              ThrowsMessage<InputError>("command line: substeps: expected 0 to 100000, got -1"));
}

TEST(Settings, EachFormerKeyStandsForOneKeyOfTheTable) {
  std::set<std::string_view> keys;
  for (const SettingRow& row : settingTable()) keys.insert(row.key);
  std::set<std::string_view> renamed;
  std::set<std::string_view> former;
  for (const SettingAlias& alias : settingAliases()) {
    EXPECT_TRUE(keys.contains(alias.key)) << alias.key;
    EXPECT_FALSE(keys.contains(alias.formerKey)) << alias.formerKey;
    EXPECT_TRUE(renamed.insert(alias.key).second) << alias.key;
    EXPECT_TRUE(former.insert(alias.formerKey).second) << alias.formerKey;
    EXPECT_EQ(formerKeyOf(alias.key), alias.formerKey);
  }
  EXPECT_EQ(renamed.size(), 9U) << "an alias that is dropped breaks the scene files of users";
  EXPECT_EQ(formerKeyOf("maxwell_ratio"), "viscoelastic_ratio");
  EXPECT_EQ(formerKeyOf("substeps"), "");
}

// Files have one name for a method in all versions; the name of the field is read as well.
TEST(Settings, MethodsAreReadByTwoNamesAndWrittenByOne) {
  const std::pair<Method, std::pair<std::string_view, std::string_view>> cases[] = {
      {Method::implicit, {"implicit", "bdf2"}},
      {Method::implicitEigen, {"implicit-eigen", "bdf2-eigen"}},
      {Method::report, {"report", "legacy-2003"}}};
  for (const auto& [method, names] : cases) {
    const auto& [written, alias] = names;
    EXPECT_EQ(nameOf(method), written);
    EXPECT_EQ(methodFromName(written, "test"), method);
    EXPECT_EQ(methodFromName(alias, "test"), method);
    EXPECT_TRUE(isNameOf(written, method));
    EXPECT_TRUE(isNameOf(alias, method));
    EXPECT_FALSE(isNameOf(alias, Method::xpbd));
  }
  EXPECT_FALSE(isNameOf("", Method::xpbd));
}

TEST(Settings, NamesReadBackAsTheyAreWritten) {
  for (const Method method :
       {Method::implicit, Method::implicitEuler, Method::implicitEigen, Method::semiImplicitEuler, Method::midpoint,
        Method::rungeKutta4, Method::report, Method::rigidPgs, Method::rigidLcp, Method::xpbd}) {
    EXPECT_EQ(methodFromName(nameOf(method), "test"), method);
  }
  for (const Inertia inertia : {Inertia::cuboid, Inertia::lumped}) EXPECT_EQ(inertiaFromName(nameOf(inertia), "test"), inertia);
  for (const Sleep sleep : {Sleep::off, Sleep::on, Sleep::report}) EXPECT_EQ(sleepFromName(nameOf(sleep), "test"), sleep);
  EXPECT_EQ(nameOf(Method::semiImplicitEuler), "semi-implicit-euler");
  EXPECT_EQ(nameOf(Method::rungeKutta4), "runge-kutta-4");
}

TEST(Settings, UnknownNamesListWhatIsAllowed) {
  EXPECT_THAT([] { methodFromName("euler", "--method"); },
              ThrowsMessage<InputError>("--method: expected implicit (also: bdf2), implicit-euler, implicit-eigen (also: "
                                        "bdf2-eigen), semi-implicit-euler, midpoint, runge-kutta-4, report (also: legacy-2003), "
                                        "rigid-pgs, rigid-lcp, xpbd or auto, got 'euler'"));
  EXPECT_THAT([] { inertiaFromName("", "--inertia"); },
              ThrowsMessage<InputError>("--inertia: expected cuboid or lumped, got ''"));
  EXPECT_THAT([] { sleepFromName("o\nn", "s.toml"); },
              ThrowsMessage<InputError>("s.toml: expected off, on or report, got 'o\\x0an'"));
}

}  // namespace
}  // namespace springtower
