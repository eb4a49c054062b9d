#pragma once

#include <string>
#include <vector>

#include "lodeline/problem/state/window.h"

namespace lodeline {

/// Parameter blocks of the fields of currents in a window: for each channel k_i in body axes, T/A.
struct CurrentStates {
  static std::string nameOf(size_t channel) { return "current_field_" + std::to_string(channel); }

  /// Finds the blocks of `channels` channels; empty without a window, and where it has none.
  CurrentStates(const Window& window, size_t channels) : CurrentStates(&window, channels) {}
  CurrentStates(const Window* window, size_t channels) {
    for (size_t i = 0; window != nullptr && i < channels; ++i) {
      ParameterBlock* block = window->findGlobal(nameOf(i));
      if (block == nullptr) break;
      blocks.push_back(block);
    }
  }

  Vec3 field_B(size_t channel) const { return Vec3(blocks[channel]->value.data()); }

  std::vector<ParameterBlock*> blocks;
};

}  // namespace lodeline
