#pragma once

#include <proj.h>

#include <memory>
#include <string>

namespace lodeline {

/// Text of PROJ, which may be a null pointer.
inline std::string textOf(const char* text) { return text == nullptr ? "" : text; }

/// A context of PROJ that neither downloads nor prints, and owners of PROJ's objects.
struct ProjObjects {
  struct Destroy {
    void operator()(PJ* object) const { proj_destroy(object); }
    void operator()(PJ_OBJ_LIST* list) const { proj_list_destroy(list); }
    void operator()(PJ_OPERATION_FACTORY_CONTEXT* factory) const {
      proj_operation_factory_context_destroy(factory);
    }
    void operator()(PJ_CONTEXT* used) const { proj_context_destroy(used); }
  };
  using Object = std::unique_ptr<PJ, Destroy>;
  using ObjectList = std::unique_ptr<PJ_OBJ_LIST, Destroy>;

  std::unique_ptr<PJ_CONTEXT, Destroy> context{proj_context_create()};

  ProjObjects() {
    proj_context_set_enable_network(context.get(), 0);
    proj_log_level(context.get(), PJ_LOG_NONE);
  }

  /// Null where PROJ does not know the definition.
  Object create(const std::string& definition) const {
    return Object(proj_create(context.get(), definition.c_str()));
  }

  /// Directions of the first two axes of a reference system: "east north", "south west".
  std::string axisDirections(const PJ* crs) const {
    const Object axes(proj_crs_get_coordinate_system(context.get(), crs));
    std::string directions;
    for (int i = 0; i < 2; ++i) {
      const char* direction = nullptr;
      proj_cs_get_axis_info(context.get(), axes.get(), i, nullptr, nullptr, &direction, nullptr, nullptr,
                            nullptr, nullptr);
      if (i > 0) directions += ' ';
      directions += textOf(direction);
    }
    return directions;
  }
};

/// Whether axes count to the west and south, in either order.
inline bool areWestAndSouth(const std::string& directions) {
  return directions == "west south" || directions == "south west";
}

}  // namespace lodeline
