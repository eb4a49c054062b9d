#include "lodeline/problem/options/dvl_options.h"

#include "lodeline/util/settings/option_check.h"

namespace lodeline {

void DvlOptions::check() const {
  OptionCheck("dvl")
      .positive("noise_inflation", noise_inflation)
      .notNegative("scale_walk_per_sqrt_s", scale_walk_per_sqrt_s)
      .positive("robust_scale_sigmas", robust_scale_sigmas)
      .positive("max_sigmas", max_sigmas)
      .notNegative("speed_sigma", speed_sigma)
      .positive("readmission_s", readmission_s);
}

}  // namespace lodeline
