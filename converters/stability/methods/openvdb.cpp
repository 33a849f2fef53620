// OpenVDB's meshToVolume, which decides by flooding from outside what a closed surface bounds. [Museth 2013]
#include "converters/image/module_loader.h"
#include "converters/stability/methods/openvdb_module.h"
#include "converters/stability/voxelizer.h"

namespace mesocell {
namespace {

struct Module {
  MesocellVdbVoxelize voxelize;
};

const Result<Module>& module() {
  static const Result<Module> loaded = []() -> Result<Module> {
    const Result<void*> handle = load_module("mesocell_openvdb");
    if (!handle) return handle.error();
    const auto version =
        reinterpret_cast<MesocellVdbModuleVersion>(find_function(*handle, "mesocell_vdb_module_version"));
    const auto run = reinterpret_cast<MesocellVdbVoxelize>(find_function(*handle, "mesocell_vdb_voxelize"));
    if (!version || !run || version() != MESOCELL_VDB_MODULE_VERSION)
      return Error{ErrorCode::kOutput,
                   "the OpenVDB module is of another version; install the one of this program"};
    return Module{run};
  }();
  return loaded;
}

}  // namespace

Status prepare_openvdb() { return module() ? Status() : Status(module().error()); }

Status voxelize_openvdb(const TriangleMesh& mesh, BitGrid& out, unsigned threads) {
  if (!module()) return module().error();
  static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Triangle) == 3 * sizeof(std::uint32_t));
  const MesocellVdbMesh plain{&mesh.vertices.data()->x, mesh.vertices.size(), mesh.triangles.data()->data(),
                              mesh.triangles.size()};
  const Index3& size = out.size();
  const MesocellVdbVoxels voxels{{size[0], size[1], size[2]}, out.words_per_row(), out.words().data()};
  char message[512] = "";
  if (module()->voxelize(&plain, &voxels, threads, message, sizeof message) != 0)
    return Error{ErrorCode::kLimit, message};
  return {};
}

}  // namespace mesocell
