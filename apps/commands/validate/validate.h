#pragma once

#include "apps/plot/plot.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace springtower {

/// One claim about the simulation and what was measured.
struct Claim {
  std::string what;
  std::string tolerance;
  std::string measured;
  std::optional<bool> passed = {};  ///< nothing for a figure that is reported and not judged
};

/// A chart that belongs to a section; written as NAME.svg and NAME.png.
struct ValidationFigure {
  std::string name;
  Plot plot;
};

/// Claims that belong together.
struct ValidationSection {
  std::string title;
  std::string text;  ///< how it was measured
  std::vector<Claim> claims = {};
  std::vector<ValidationFigure> figures = {};
  std::vector<std::string> notes = {};  ///< details of what failed, one line each
  double wall_s = 0.0;
};

/// Options of all sections.
struct ValidationPlan {
  bool longForm = false;  ///< every scene of every set; else a part that takes seconds
  std::string oracle;     ///< folder with the sets of towers and what statics says of them
  std::string scenes;     ///< folder with the scenes of the repository
};

/// Verdicts against the reference sets, with sleep and without.
ValidationSection validateVerdicts(const ValidationPlan& plan);
/// The forces that `run --report --forces` writes, added up again.
ValidationSection validateForces(const ValidationPlan& plan);
/// Blocks pulled with a slowly growing force.
ValidationSection validatePulls(const ValidationPlan& plan);
/// Gravity turned slowly until the tower goes.
ValidationSection validateTilts(const ValidationPlan& plan);
/// Which blocks of uneven towers carry nothing.
ValidationSection validateLoose(const ValidationPlan& plan);
/// Other sizes, densities and a tower of very different weights.
ValidationSection validateScale(const ValidationPlan& plan);
/// The report's sequence of moves, and blocks pulled out one by one.
ValidationSection validateMoves(const ValidationPlan& plan);
/// How many blocks wake, and that what must fall falls.
ValidationSection validateSleep(const ValidationPlan& plan);

/// A section and its name on the command line.
struct ValidationPart {
  std::string_view name;
  ValidationSection (*run)(const ValidationPlan&);
};

/// All sections in the order of the page.
const std::vector<ValidationPart>& validationParts();

/// One requirement of the 2003 report (its section 3.6) and the tests or claims that show it.
struct Requirement {
  std::string_view number;
  std::string_view text;
  std::string_view shownBy;
};
const std::vector<Requirement>& reportRequirements();

}  // namespace springtower
