#pragma once

namespace lodeline {

/// Properties of a cave's rock. Lengths in m, fractions between 0 and 1.
struct CaveStyle {
  float boulders_per_m = 2.0f;     ///< breakdown blocks per length of the passage
  float largest_boulder_m = 0.8f;  ///< radius
  float stalactites_per_m = 0.0f;  ///< together with their stalagmites and columns
  float sediment_fill = 0.28f;     ///< height of the silt on the floor, as a fraction of the passage height
  float bare_share = 0.10f;        ///< fraction of walls and floor covered by smooth silt or flowstone
  float ledge_m = 0.30f;           ///< depth of the ledges along the bedding planes
  float rock_albedo = 0.42f;
  float sediment_albedo = 0.33f;
  float flowstone_albedo = 0.52f;

  /// Florida's Devil's Eye: ledged, dark limestone, silty floor.
  static CaveStyle floridaSpring() { return {}; }

  /// Yucatán's Dos Ojos: pale, decorated passages that were once dry.
  static CaveStyle yucatanDecorated() {
    CaveStyle style;
    style.boulders_per_m = 0.8f;
    style.stalactites_per_m = 12.0f;
    style.ledge_m = 0.12f;
    style.rock_albedo = 0.50f;
    style.sediment_albedo = 0.42f;
    style.flowstone_albedo = 0.56f;
    style.bare_share = 0.15f;
    return style;
  }
};

}  // namespace lodeline
