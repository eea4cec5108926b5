// Times VTK's screen-space fluid renderer (vtkOpenGLFluidMapper: spheres splatted, depth smoothed by the narrow-range
// filter, thickness splatted, both shaded) on particles and a camera of `meniscus bench table1 --write-frames`.
//
//   vtk_fluid particles.ply table1.json picture.png frames
//
// table1.json is what the bench has printed: its camera, and the row of as many particles. A frame is uploaded anew,
// as that of a film is, rendered, and read back; the median of `frames` is told, after one that warms up and one of the
// same particles. Prints one JSON object.
#include <vtkAutoInit.h>
#include <vtkCamera.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkImageFlip.h>
#include <vtkNew.h>
#include <vtkOpenGLFluidMapper.h>
#include <vtkOpenGLRenderWindow.h>
#include <vtkPLYReader.h>
#include <vtkPNGWriter.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkRenderer.h>
#include <vtkTexture.h>
#include <vtkUnsignedCharArray.h>
#include <vtkVolume.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

namespace {

using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

// The points alone, with the vertices that the mapper draws.
vtkNew<vtkPolyData> cloud_of(const char* path) {
  vtkNew<vtkPLYReader> reader;
  reader->SetFileName(path);
  reader->Update();
  vtkNew<vtkPolyData> cloud;
  cloud->SetPoints(reader->GetOutput()->GetPoints());
  return cloud;
}

const Json& row_of(const Json& table, std::size_t particles) {
  for (const Json& row : table["rows"])
    if (row["particles"] == particles) return row;
  std::fprintf(stderr, "no row of %zu particles\n", particles);
  std::exit(1);
}

// The sky over a ground: what the surface mirrors and what stands behind it.
vtkNew<vtkTexture> surroundings() {
  constexpr int kWidth = 512, kHeight = 256;
  vtkNew<vtkImageData> image;
  image->SetDimensions(kWidth, kHeight, 1);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const double up = 2.0 * y / (kHeight - 1) - 1;
      auto* pixel = static_cast<unsigned char*>(image->GetScalarPointer(x, y, 0));
      const double sky[3] = {150 - 90 * up, 185 - 70 * up, 225 - 40 * up}, ground[3] = {120, 128, 132};
      for (int c = 0; c < 3; ++c) pixel[c] = static_cast<unsigned char>(up > 0 ? sky[c] : ground[c]);
    }
  vtkNew<vtkTexture> texture;
  texture->SetInputData(image);
  texture->SetColorModeToDirectScalars();
  texture->MipmapOn();
  texture->InterpolateOn();
  return texture;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: vtk_fluid particles.ply table1.json picture.png frames\n");
    return 2;
  }
  const vtkNew<vtkPolyData> cloud = cloud_of(argv[1]);
  Json table;
  std::ifstream(argv[2]) >> table;
  const auto particles = static_cast<std::size_t>(cloud->GetNumberOfPoints());
  const Json& row = row_of(table, particles);
  const int size = row["size"], frames = std::max(1, std::atoi(argv[4]));
  const float spacing = row["spacing"];

  // Filter, mode and attenuation as in VTK's own test of the mapper. The radius should be "slightly larger" than half
  // the spacing, says the documentation, and is 0.9 spacings in that test; below 0.8 this cloud's surface has holes.
  vtkNew<vtkOpenGLFluidMapper> mapper;
  mapper->SetInputData(cloud);
  mapper->SetParticleRadius(0.8f * spacing);
  mapper->SetSurfaceFilterMethod(vtkOpenGLFluidMapper::NarrowRange);
  mapper->SetSurfaceFilterIterations(3);
  mapper->SetSurfaceFilterRadius(5);
  mapper->SetDisplayMode(vtkOpenGLFluidMapper::TransparentFluidVolume);
  mapper->SetAttenuationColor(0.8f, 0.2f, 0.15f);
  mapper->SetAttenuationScale(1.5f);
  vtkNew<vtkVolume> volume;
  volume->SetMapper(mapper);

  const auto vec = [&](const char* key) {
    return std::vector<double>{table["camera"][key][0], table["camera"][key][1], table["camera"][key][2]};
  };
  const auto eye = vec("eye"), forward = vec("forward"), up = vec("up");
  vtkNew<vtkRenderer> renderer;
  renderer->AddVolume(volume);
  renderer->UseImageBasedLightingOn();
  const vtkNew<vtkTexture> sky = surroundings();
  renderer->SetEnvironmentTexture(sky);
  renderer->SetBackground(0.47, 0.5, 0.52);
  vtkCamera* camera = renderer->GetActiveCamera();
  camera->SetPosition(eye.data());
  camera->SetFocalPoint(eye[0] + forward[0], eye[1] + forward[1], eye[2] + forward[2]);
  camera->SetViewUp(up.data());
  camera->SetViewAngle(table["camera"]["vertical_fov_deg"]);
  renderer->ResetCameraClippingRange();

  vtkNew<vtkRenderWindow> window;
  window->SetOffScreenRendering(1);
  window->SetMultiSamples(0);
  window->SetSize(size, size);
  window->AddRenderer(renderer);

  vtkNew<vtkUnsignedCharArray> pixels;
  std::vector<double> fresh;
  const auto frame = [&] {
    const auto start = Clock::now();
    window->Render();
    window->GetPixelData(0, 0, size - 1, size - 1, 0, pixels);
    return ms_since(start);
  };
  frame();  // shaders are compiled
  const double still = frame();
  for (int i = 0; i < frames; ++i) {
    cloud->GetPoints()->Modified();
    cloud->Modified();
    mapper->Modified();
    fresh.push_back(frame());
  }
  const auto median = [](std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
    return values[values.size() / 2];
  };

  vtkNew<vtkImageData> image;
  image->SetDimensions(size, size, 1);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  std::copy_n(pixels->GetPointer(0), 3 * static_cast<std::size_t>(size) * static_cast<std::size_t>(size),
              static_cast<unsigned char*>(image->GetScalarPointer()));
  vtkNew<vtkPNGWriter> writer;
  writer->SetFileName(argv[3]);
  writer->SetInputData(image);
  writer->Write();

  std::string device = window->ReportCapabilities();
  const auto at = device.find("OpenGL renderer string:");
  device = at == std::string::npos ? "" : device.substr(at + 25, device.find('\n', at) - at - 25);
  const Json result = {{"particles", particles},
                       {"size", size},
                       {"frame_ms", median(fresh)},
                       {"same_particles_ms", still},
                       {"renderer", device},
                       {"meniscus_ms", row["frame_ms"]},
                       {"ratio", median(fresh) / row["frame_ms"].get<double>()}};
  std::printf("%s\n", result.dump().c_str());
  return 0;
}
