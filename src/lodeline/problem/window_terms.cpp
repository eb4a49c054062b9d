#include "lodeline/problem/window_terms.h"

#include "lodeline/problem/state/camera_states.h"

namespace lodeline {
namespace {

void repropagateIfNeeded(const Frame& before, Preintegration& preintegration) {
  if (preintegration.needsRepropagation(before.gyroscopeBias(), before.accelerometerBias())) {
    preintegration.repropagate(before.gyroscopeBias(), before.accelerometerBias());
  }
}

}  // namespace

std::vector<Factor> collectGlobalTerms(Window& window, const FactorBuilder& factors) {
  std::vector<Factor> terms = factors.imuAxes(window);
  for (ParameterBlock* secondary : cameraStates(window).secondary) {
    if (auto placement = factors.placement(*secondary)) terms.push_back(std::move(*placement));
  }
  for (const auto& state : window.globals()) {
    if (auto prior = factors.priorOf(*state)) terms.push_back(std::move(*prior));
  }
  return terms;
}

std::vector<Factor> collectMotionTerms(Window& window, const FactorBuilder& factors) {
  std::vector<Factor> terms = collectGlobalTerms(window, factors);
  Frame* before = nullptr;
  for (const auto& frame : window.frames()) {
    frame->updateImageMotion();
    if (before && frame->from_previous) {
      repropagateIfNeeded(*before, *frame->from_previous);
      terms.push_back(factors.inertial(window, *before, *frame));
    }
    before = frame.get();
  }
  before = nullptr;
  for (const auto& frame : window.frames()) {
    for (const auto& measurement : frame->measurements) {
      for (Factor& factor : measurement->factors({factors, window, before, *frame}))
        terms.push_back(std::move(factor));
    }
    if (auto factor = factors.rest(*frame)) terms.push_back(std::move(*factor));
    before = frame.get();
  }
  return terms;
}

WindowTerms collectTerms(Window& window, const Prior& prior, const FactorBuilder& factors) {
  WindowTerms terms;
  if (!prior.empty()) terms.dense.push_back(factors.prior(prior));
  for (Factor& factor : collectMotionTerms(window, factors)) terms.dense.push_back(std::move(factor));
  for (auto& [id, track] : window.tracks()) {
    if (track.landmark) terms.landmarks.push_back(factors.landmark(window, track));
  }
  return terms;
}

NormalEquations linearize(const WindowTerms& terms) {
  NormalEquations system;
  for (const Factor& factor : terms.dense) system.add(factor);
  for (const LandmarkFactors& landmark : terms.landmarks) system.addEliminated(landmark);
  return system;
}

}  // namespace lodeline
