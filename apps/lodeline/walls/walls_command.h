#pragma once

namespace CLI {
class App;
}

namespace lodeline {

void addWallsCommand(CLI::App& program);

}  // namespace lodeline
