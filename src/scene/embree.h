/// Embree 3 [Wald2014]: the one device of the process, and owners of its objects.
#pragma once

#include <embree3/rtcore.h>
#include <memory>

namespace meniscus {

/// The device; made at the first call. Its hierarchies are built on the calling thread, so that they are the same for
/// any number of threads; queries come from any thread.
RTCDevice embree_device();

/// @throws Error limit_exceeded: no memory; unsupported: anything else that Embree has reported on this thread
void check_embree();

struct ReleaseScene {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using EmbreeScene = std::unique_ptr<RTCSceneTy, ReleaseScene>;

/// An empty scene whose hits do not miss edges between triangles.
EmbreeScene make_embree_scene();

struct ReleaseGeometry {
  void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
using EmbreeGeometry = std::unique_ptr<RTCGeometryTy, ReleaseGeometry>;

}  // namespace meniscus
