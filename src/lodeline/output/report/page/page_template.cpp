#include "lodeline/output/report/page/page_template.h"

namespace lodeline {

std::string_view pageTemplate() {
#ifdef LODELINE_REPORT
  static constexpr char kText[] =
#include "page_template_text.inc"
      ;
  return {kText, sizeof(kText) - 1};
#else
  return {};
#endif
}

}  // namespace lodeline
