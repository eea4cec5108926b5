#pragma once

#include "meniscus/output.h"
#include "output/ffmpeg.h"
#include "output/frame_rate.h"

namespace meniscus {

/// An open H.264 encoder of yuv420p, BT.709 colours, limited range: libx264, else any other that there is.
///
/// The same pictures give the same bits on any machine: the encoder's threads are a fixed number, as they are
/// part of what it writes.
/// @param width, height  even, px
/// @param quality_crf    other encoders than libx264 get a bit rate that comes near
/// @throws Error unsupported: no encoder, or none for this size
FfmpegOwner<AVCodecContext> open_h264(const std::string& path, int width, int height, FrameRate rate, int quality_crf);

}  // namespace meniscus
