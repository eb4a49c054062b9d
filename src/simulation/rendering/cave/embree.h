#pragma once

// Common interface to Embree 4 where installed (Ubuntu 24.04), otherwise Embree 3 (Debian 12).
#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace lodeline::embree {

// Marks the rays of a packet as coherent.
#if RTC_VERSION_MAJOR >= 4
inline void intersect16(const int* valid, RTCScene scene, RTCRayHit16* query) {
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  rtcIntersect16(valid, scene, query, &arguments);
}

inline void occluded16(const int* valid, RTCScene scene, RTCRay16* query) {
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  rtcOccluded16(valid, scene, query, &arguments);
}

inline void intersect1(RTCScene scene, RTCRayHit* query) { rtcIntersect1(scene, query, nullptr); }
#else
inline RTCIntersectContext coherentContext() {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  return context;
}

inline void intersect16(const int* valid, RTCScene scene, RTCRayHit16* query) {
  RTCIntersectContext context = coherentContext();
  rtcIntersect16(valid, scene, &context, query);
}

inline void occluded16(const int* valid, RTCScene scene, RTCRay16* query) {
  RTCIntersectContext context = coherentContext();
  rtcOccluded16(valid, scene, &context, query);
}

inline void intersect1(RTCScene scene, RTCRayHit* query) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, query);
}
#endif

}  // namespace lodeline::embree
