#pragma once

#include "lodeline/types.h"

namespace lodeline {

/// Angle by which a rotation turns about the vertical, rad in (-pi, pi]: the twist of its swing-twist
/// decomposition about z. Zero where the rotation is half a turn about a horizontal axis.
double azimuthOf(const Quat& rotation);

/// Motion of four degrees of freedom (translation and azimuth) between the worlds in which one body has two
/// poses. It maps the body's position exactly, and roll and pitch stay those of the odometry.
Rigid3 mapFromOdom(const Rigid3& map_from_body, const Rigid3& odom_from_body);

}  // namespace lodeline
