#include "scene/embree.h"

#include <fmt/format.h>

#include "meniscus/base.h"

namespace meniscus {

RTCDevice embree_device() {
  // Never released: solids may outlive every static object. A number of threads given here would limit oneTBB, and with
  // it all loops of the process, for as long as the device lives.
  static const RTCDevice device = rtcNewDevice("threads=0");
  if (!device) throw Error(ErrorCode::unsupported, "Embree cannot be started on this machine");
  return device;
}

void check_embree() {
  const RTCError error = rtcGetDeviceError(embree_device());
  if (error == RTC_ERROR_NONE) return;
  if (error == RTC_ERROR_OUT_OF_MEMORY)
    throw Error(ErrorCode::limit_exceeded, "there is not enough memory for the solids' hierarchies");
  throw Error(ErrorCode::unsupported, fmt::format("Embree reports its error {}", static_cast<int>(error)));
}

EmbreeScene make_embree_scene() {
  EmbreeScene scene(rtcNewScene(embree_device()));
  check_embree();
  rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_MEDIUM);
  return scene;
}

}  // namespace meniscus
