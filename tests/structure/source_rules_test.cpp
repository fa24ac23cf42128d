#include "tests/structure/source_rules.h"

#include "tests/support/program.h"
#include "tests/support/says.h"

#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <string>

namespace springtower {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(SourceRules, TheProjectKeepsThem) {
  // A wrong root would have nothing to complain about.
  ASSERT_GT(sourceFiles(SPRINGTOWER_SOURCE_DIR).size(), 10U);
  EXPECT_THAT(brokenRulesInTree(SPRINGTOWER_SOURCE_DIR), IsEmpty());
}

TEST(SourceRules, EachFolderKnowsItselfAndTheFoldersBelow) {
  const std::vector<std::string> folders = {"core", "broadphase", "narrowphase", "solver",   "scenarios",
                                            "api",  "apps",       "bench",       "examples", "tests"};
  const std::vector<std::string> allowed = {
      "1000000000",  // core
      "1100000000",  // broadphase
      "1010000000",  // narrowphase
      "1111000000",  // solver
      "1000100000",  // scenarios
      "1001110000",  // api
      "1111101000",  // apps
      "1111100100",  // bench
      "0000000000",  // examples
      "1111111001",  // tests
  };
  for (size_t from = 0; from < folders.size(); ++from) {
    for (size_t to = 0; to < folders.size(); ++to) {
      const auto broken = brokenRules(folders[from] + "/user.cpp", "#include \"" + folders[to] + "/used.h\"\n");
      EXPECT_EQ(broken.empty(), allowed[from][to] == '1') << folders[from] << " includes " << folders[to];
    }
  }
}

TEST(SourceRules, PublicHeadersKnowTheStandardLibraryAlone) {
  const std::string once = "#pragma once\n";
  const std::string header = "include/springtower/world.h";
  EXPECT_THAT(brokenRules(header, once + "#include <vector>\n#include <springtower/scene.h>\n"), IsEmpty());
  EXPECT_THAT(brokenRules(header, once + "#include \"core/state.h\"\n"), ElementsAre(HasSubstr("include must not include core")));
  EXPECT_THAT(brokenRules(header, once + "#include <Eigen/Core>\n"), ElementsAre(HasSubstr("the standard library alone")));
  EXPECT_THAT(brokenRules(header, once + "#include <math.h>\n"), ElementsAre(HasSubstr("the standard library alone")));
  EXPECT_THAT(brokenRules(header, once + "#include \"springtower/scene.h\"\n"), ElementsAre(HasSubstr("angle brackets")));
  EXPECT_THAT(brokenRules("api/world.cpp", "#include <springtower/world.h>\n"), IsEmpty());
  EXPECT_THAT(brokenRules("examples/tower.cpp", "#include <springtower/world.h>\n"), IsEmpty());
  EXPECT_THAT(brokenRules("tests/api/world_test.cpp", "#include <springtower/world.h>\n"), IsEmpty());
  for (const std::string inside : {"core", "solver", "scenarios", "apps", "bench"}) {
    EXPECT_THAT(brokenRules(inside + "/user.cpp", "#include <springtower/world.h>\n"),
                ElementsAre(HasSubstr(inside + " must not include the public headers")));
  }
  EXPECT_THAT(brokenRules("api/world.cpp", "#include \"include/springtower/world.h\"\n"),
              ElementsAre(HasSubstr("<springtower/...>")));
}

TEST(SourceRules, ThePublicInterfaceIsSmall) {
  const ScratchFolder folder;
  const std::filesystem::path& root = folder.path();
  std::filesystem::create_directories(root / "include/springtower");
  const auto add = [&](int number) {
    std::ofstream(root / ("include/springtower/part" + std::to_string(number) + ".h")) << "#pragma once\n";
  };
  for (int i = 0; i < kMaxPublicHeaders; ++i) add(i);
  EXPECT_THAT(brokenRulesInTree(root), IsEmpty());
  add(kMaxPublicHeaders);
  EXPECT_THAT(brokenRulesInTree(root), ElementsAre(HasSubstr("8 public headers")));
}

TEST(SourceRules, ARoomOfTheSolverKnowsThoseBeforeIt) {
  EXPECT_THAT(brokenRules("solver/implicit/newton.cpp", "#include \"solver/contact/update.h\"\n"), IsEmpty());
  EXPECT_THAT(brokenRules("solver/implicit/newton.cpp", "#include \"solver/implicit/system.h\"\n"), IsEmpty());
  EXPECT_THAT(brokenRules("solver/contact/update.cpp", "#include \"solver/implicit/newton.h\"\n"),
              ElementsAre(HasSubstr("solver/contact must not include solver/implicit")));
  EXPECT_THAT(brokenRules("solver/contact/update.cpp", "#include \"solver/attic/old.h\"\n"), ElementsAre(HasSubstr("no place")));
  EXPECT_THAT(brokenRules("apps/viewer/app/main.cpp", "#include \"solver/implicit/system.h\"\n"), IsEmpty());
}

TEST(SourceRules, TheOtherFoldersHaveAnOrderToo) {
  EXPECT_THAT(brokenRules("core/scene/scene.h", "#pragma once\n#include \"core/settings.h\"\n"), IsEmpty());
  EXPECT_THAT(brokenRules("core/settings.cpp", "#include \"core/scene/scene.h\"\n"),
              ElementsAre(HasSubstr("core must not include core/scene")));
  EXPECT_THAT(brokenRules("narrowphase/exact/cubic.cpp", "#include \"narrowphase/manifold.h\"\n"),
              ElementsAre(HasSubstr("narrowphase/exact must not include narrowphase")));
  EXPECT_THAT(brokenRules("apps/plot/axis.cpp", "#include \"apps/commands/profile/profile.h\"\n"),
              ElementsAre(HasSubstr("apps/plot must not include apps/commands/profile")));
  EXPECT_THAT(brokenRules("apps/commands/validate/sleep.cpp", "#include \"apps/commands/run/report.h\"\n"), IsEmpty());
  EXPECT_THAT(brokenRules("apps/viewer/ui/panels.cpp", "#include \"apps/viewer/view/state.h\"\n"), IsEmpty());
  EXPECT_THAT(brokenRules("apps/viewer/view/state.cpp", "#include \"apps/viewer/render/render.h\"\n"),
              ElementsAre(HasSubstr("apps/viewer/view must not include apps/viewer/render")));
  // A folder in a room has the place of the room; one beside the rooms has none, nor has a file there.
  EXPECT_THAT(brokenRules("apps/viewer/ui/plot/bars.cpp", "#include \"apps/viewer/ui/panels.h\"\n"), IsEmpty());
  EXPECT_THAT(brokenRules("apps/viewer/io/film/gif.cpp", "#include \"apps/viewer/ui/panels.h\"\n"),
              ElementsAre(HasSubstr("apps/viewer/io/film must not include apps/viewer/ui")));
  EXPECT_THAT(brokenRules("apps/viewer/flat.cpp", "#include \"apps/viewer/session/session.h\"\n"),
              ElementsAre(HasSubstr("no place")));
  EXPECT_THAT(brokenRules("apps/commands/attic/old.cpp", "#include \"apps/plot/plot.h\"\n"), ElementsAre(HasSubstr("no place")));
}

TEST(SourceRules, FunctionsAreShort) {
  const auto function = [](int lines, const std::string& margin) {
    std::string text = margin + "int f(int x) {\n";
    for (int line = 2; line < lines; ++line) text += margin + "  ++x;\n";
    return text + margin + "}\n";
  };
  EXPECT_THAT(brokenRules("core/state.cpp", function(kMaxFunctionLines, "")), IsEmpty());
  EXPECT_THAT(brokenRules("core/state.cpp", function(kMaxFunctionLines + 1, "")),
              ElementsAre("core/state.cpp:61: ends a function of 61 lines, more than 60"));
  EXPECT_THAT(brokenRules("core/state.cpp", "struct S {\n" + function(kMaxFunctionLines + 1, "  ") + "};\n"),
              ElementsAre(HasSubstr("61 lines")));
  // A head may take more than a line, and a template or a macro stand before it.
  std::string head =
      "template <bool Floor>\nSPRINGTOWER_INLINE void f(const Manifold& manifold,\n                          int x) {\n";
  for (int line = 4; line < kMaxFunctionLines + 1; ++line) head += "  ++x;\n";
  EXPECT_THAT(brokenRules("core/state.cpp", head + "}\n"), IsEmpty());
  EXPECT_THAT(brokenRules("core/state.cpp", head + "  ++x;\n}\n"), ElementsAre(HasSubstr("61 lines")));
}

TEST(SourceRules, NameTheFileTheLineAndTheReason) {
  EXPECT_THAT(brokenRules("core/state.cpp", "#include \"core/state.h\"\n\n  #  include \"solver/step.h\"\n"),
              ElementsAre("core/state.cpp:3: #include of solver/step.h: core must not include solver"));
}

TEST(SourceRules, IncludesAreWrittenFromTheRootAndInQuotes) {
  EXPECT_THAT(brokenRules("core/state.cpp", "#include \"state.h\"\n"), ElementsAre(HasSubstr("from the repository root")));
  EXPECT_THAT(brokenRules("core/state.cpp", "#include \"../solver/step.h\"\n"), ElementsAre(HasSubstr("repository root")));
  EXPECT_THAT(brokenRules("core/state.cpp", "#include <solver/step.h>\n"), ElementsAre(HasSubstr("needs quotes")));
  EXPECT_THAT(brokenRules("core/state.cpp", "#include <vector>\n#include <Eigen/Core>\n// #include \"x.h\"\n"), IsEmpty());
}

TEST(SourceRules, HeadersAreGuardedAndFilesAreShort) {
  EXPECT_THAT(brokenRules("core/state.h", "#pragma once\n"), IsEmpty());
  EXPECT_THAT(brokenRules("core/state.h", "struct State;\n"), ElementsAre(HasSubstr("#pragma once")));
  std::string text;
  for (int line = 0; line < kMaxLines; ++line) text += "//\n";
  EXPECT_THAT(brokenRules("core/state.cpp", text), IsEmpty());
  EXPECT_THAT(brokenRules("core/state.cpp", text + "//\n"), ElementsAre("core/state.cpp: 801 lines, more than 800"));
}

TEST(SourceRules, AFilePlantedDeepInATreeIsFound) {
  const ScratchFolder folder;
  const std::filesystem::path& root = folder.path();
  std::filesystem::create_directories(root / "broadphase/detail");
  std::ofstream(root / "broadphase/sweep.cpp") << "#include \"core/state.h\"\n";
  EXPECT_THAT(brokenRulesInTree(root), IsEmpty());
  std::ofstream(root / "broadphase/detail/islands.h") << "#pragma once\n#include \"narrowphase/exact/cubic.h\"\n";
  EXPECT_THAT(brokenRulesInTree(root), ElementsAre(HasSubstr("broadphase/detail/islands.h:2: ")));
}

TEST(SourceRules, TheSolverHasFewFilesBesideItsFolders) {
  const ScratchFolder folder;
  const std::filesystem::path& root = folder.path();
  std::filesystem::create_directories(root / "solver");
  for (int i = 0; i < kMaxFlatFiles; ++i) std::ofstream(root / ("solver/file" + std::to_string(i) + ".cpp")) << "\n";
  EXPECT_THAT(brokenRulesInTree(root), IsEmpty());
  std::ofstream(root / "solver/one_more.cpp") << "\n";
  EXPECT_THAT(brokenRulesInTree(root), ElementsAre(HasSubstr("13 files")));
}

TEST(SourceRules, ATestHasItsFilesInAFolderOfItsOwn) {
  const std::string shared = std::string("const auto path = testing::TempDir") + "();\n";
  EXPECT_THAT(brokenRules("tests/core/a_test.cpp", shared), ElementsAre(HasSubstr("ScratchFolder")));
  EXPECT_THAT(brokenRules("tests/support/program.cpp", shared), IsEmpty());
  EXPECT_THAT(brokenRules("core/a.cpp", shared), IsEmpty());
}

TEST(SourceRules, NoStateDependsOnTheMachinesMathematics) {
  const std::string call = std::string("const double a = std::") + "sin(b);\n";
  for (const std::string folder : {"core", "broadphase", "narrowphase/exact", "solver/hand", "scenarios", "api"})
    EXPECT_THAT(brokenRules(folder + "/a.cpp", call), ElementsAre(says("a.cpp:1: expected ..., got std::sin("))) << folder;
  for (const std::string folder : {"apps/plot", "bench", "tests/core"})
    EXPECT_THAT(brokenRules(folder + "/a.cpp", call), IsEmpty()) << folder;
  for (const std::string found : {"std::pow(a, 2)", "std::exp(a)", "std::atan2(a, b)", "std::hypot(a, b)", "std::fma(a, b, c)",
                                  "std::log1p(a)", "std::cbrtf(a)", "pow(a, 2)", "-sin(a)", "__builtin_cos(a)", " ::tanh(a)",
                                  "Eigen::AngleAxisd(a, b)", "a.slerp(b, c)", "a.angularDistance(b)", "a.array().exp()",
                                  "a.array().pow(1.5)", "a.array().acos()", "a.array().log2()", "std::normal_distribution<> a"})
    EXPECT_THAT(brokenRules("core/a.cpp", "x = " + found + ";\n"), ElementsAre(HasSubstr("depend on the machine"))) << found;
  for (const std::string found :
       {"std::sqrt(a)", "std::floor(a)", "std::lround(a)", "std::ldexp(a, 2)", "elementary::sin(a)", "std::expected(a)",
        "elementary::pow(a)", "my_sin(a)", "a.cos(b)", "f(a);  // not std::sin(a)", "a.exponential()"})
    EXPECT_THAT(brokenRules("core/a.cpp", "x = " + found + ";\n"), IsEmpty()) << found;
}

TEST(SourceRules, AConstantOfTheTuningTableMayComeFromAFile) {
  const std::string value = " double kHalf = 0.5 * tuning::kMaxStrain;\n";
  EXPECT_THAT(brokenRules("solver/step.cpp", "const" + value), IsEmpty());
  EXPECT_THAT(brokenRules("solver/step.cpp", "constexpr" + value),
              ElementsAre(says("solver/step.cpp:1: expected const, got constexpr")));
  EXPECT_THAT(brokenRules("solver/step.cpp", "constexpr double kHalf = 0.5;  // of tuning::kMaxStrain\n"), IsEmpty());
}

TEST(SourceRules, AHeaderIncludesWhatItUsesOfTheStandardLibrary) {
  const std::string head = "#pragma once\n";
  EXPECT_THAT(brokenRules("core/a.h", head + "std::vector<int> a;\n"), ElementsAre("core/a.h: std::vector needs <vector>"));
  EXPECT_THAT(brokenRules("core/a.h", head + "#include <vector>\nstd::vector<int> a;\n"), IsEmpty());
  EXPECT_THAT(brokenRules("core/a.h", head + "int a;  // not a std::vector\n"), IsEmpty());
  EXPECT_THAT(brokenRules("core/a.h", head + "#include <string>\nstd::string_view a;\n"), IsEmpty());
  EXPECT_THAT(brokenRules("core/a.cpp", "std::vector<int> a;\n"), IsEmpty());
}

}  // namespace
}  // namespace springtower
