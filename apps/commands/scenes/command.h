#pragma once

namespace CLI {
class App;
}  // namespace CLI

namespace springtower {

/// Adds the command `springtower scenes` to the program. It has no options.
CLI::App* defineScenes(CLI::App& program);

/// Prints every scene that has a name (scenarios/registry.h): how it is written, what it is, its size unless one is given and the
/// sizes that are allowed. Returns the exit code.
int executeScenes();

}  // namespace springtower
