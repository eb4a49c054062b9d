#include "lodeline/mapping/graph/graph_elements.h"

#include <algorithm>

namespace lodeline {
namespace {

int countLoops(const std::vector<FactorReport>& factors, bool accepted) {
  return static_cast<int>(std::count_if(factors.begin(), factors.end(), [&](const FactorReport& factor) {
    return factor.kind == FactorReport::Kind::Loop && factor.accepted == accepted;
  }));
}

}  // namespace

int GraphSummary::acceptedLoops() const { return countLoops(factors, true); }
int GraphSummary::refusedLoops() const { return countLoops(factors, false); }

}  // namespace lodeline
