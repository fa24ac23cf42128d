#include "core/settings.h"

#include "api/convert.h"

#include <springtower/settings.h>

namespace springtower::api {

void checkSettings(const Settings& settings) {
  withPublicErrors([&] { springtower::checkSettings(toEngine(settings), "settings"); });
}

Method methodFromName(std::string_view name) {
  return withPublicErrors([&] { return toPublic(springtower::methodFromName(name, "method")); });
}

std::string nameOf(Method method) {
  return std::string(springtower::nameOf(toEngine(method)));
}

}  // namespace springtower::api
