#include "lodeline/util/build/decompositions.h"

namespace Eigen {
LODELINE_DECOMPOSITIONS()
}  // namespace Eigen
