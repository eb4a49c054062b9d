#include "lodeline/streams/inertial_screen.h"

#include <gtest/gtest.h>

namespace lodeline {
namespace {}  // namespace
}  // namespace lodeline
