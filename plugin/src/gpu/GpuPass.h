#pragma once

#include "core/Result.h"
#include "gpu/ComputeProgram.h"
#include "gpu/Resource.h"

#include <osg/Array>
#include <osg/BufferIndexBinding>
#include <osg/Referenced>
#include <osg/State>
#include <osg/Texture>
#include <osg/Uniform>

#include <map>
#include <set>
#include <string>
#include <vector>

namespace osgTerrainLight
{

/// One compute shader with the textures it reads and writes. A dispatch ends with the memory
/// barrier that lets later passes and draws read what it wrote: OSG issues none.
class GpuPass : public osg::Referenced
{
public:
    /// name: stem of shaders/passes/<name>.comp. defines: a variant, see ShaderVariants in the
    /// tests.
    explicit GpuPass(std::string name, std::vector<std::string> defines = {});

    const std::string& name() const { return _name; }

    /// Another variant from the next dispatch on.
    void setDefines(std::vector<std::string> defines);

    /// Declares that sampler `uniform` reads `texture`, or the image, where the shader declares a
    /// `readonly uniform` image of that name. Texture units are counted up from 0, image units from
    /// those that writes() names on. Null: the variant has no such uniform or does not read it, and
    /// what it read before is let go. A sampler's unit remains: OpenGL forbids two types of sampler
    /// in one.
    void reads(const std::string& uniform, osg::Texture* texture);
    /// The same of the texture that the resource has when the pass is dispatched.
    void reads(const std::string& uniform, Resource* resource);
    void reads(const std::string& uniform, std::nullptr_t)
    {
        reads(uniform, static_cast<osg::Texture*>(nullptr));
    }

    enum class Access
    {
        Write,
        ReadWrite
    };
    /// Declares that image unit `unit` is written, or read and written. Units are declared from 0
    /// up. Arrays, cube maps and 3D textures are bound with all their layers, faces or slices.
    void writes(unsigned unit, osg::Texture* texture, Access access = Access::Write);
    void writes(unsigned unit, Resource* resource, Access access = Access::Write);

    template <class T>
    void set(const std::string& uniform, const T& value)
    {
        osg::ref_ptr<osg::Uniform>& slot = _uniforms[uniform];
        if (!slot)
            slot = new osg::Uniform(uniform.c_str(), value);
        else
            slot->set(value);
    }
    void set(const std::string& uniform, int x, int y);
    void set(osg::Uniform* uniform) { _uniforms[uniform->getName()] = uniform; }

    /// The contents of the shader's uniform block at `binding`: layout std140, arrays of vec4, as
    /// many values as the block declares. Tables belong there: OpenGL guarantees a compute shader
    /// 256 vectors in plain uniforms, and 1024 in each of 12 blocks.
    void setBlock(const std::vector<osg::Vec4f>& values, unsigned binding = 0);

    /// Declares that the shader storage block at `binding` (layout std430) reads and writes a
    /// buffer of these values. Passes share a buffer by naming the same array. The array's content
    /// is uploaded at first and whenever it is dirty; readStorage() brings back what shaders wrote.
    void setStorage(unsigned binding, osg::Array* values);

    struct Groups
    {
        unsigned x = 1, y = 1, z = 1;
    };

    /// Runs the shader. Needs a current context of OpenGL 4.3. An error names file and line of the
    /// shader. In a PacedRun it may run in pieces, where the shader goes by INVOCATION or GROUP
    /// (pieces.glsl), and all that it writes are resources that may be cut.
    Status dispatch(osg::State& state, Groups groups);

    /// Number of groups of `size` that cover `count`.
    static unsigned groupsFor(int count, int size);

    void releaseGLObjects(osg::State* state) const;
    void resizeGLObjectBuffers(unsigned size);

private:
    ~GpuPass() override;
    Status compose();
    Status link(osg::State& state);
    void dropProgram();
    bool isWhole() const;
    void bindImages(osg::State& state);
    void leave(osg::State& state) const;

    struct Input
    {
        std::string uniform;
        osg::ref_ptr<osg::Texture> texture;
        osg::ref_ptr<Resource> resource; ///< where the texture comes from; null: it is given
    };
    struct Output
    {
        osg::ref_ptr<osg::Texture> texture;
        Access access = Access::Write;
        osg::ref_ptr<Resource> resource; ///< as above
    };
    class Resolved;
    Status dispatch(osg::State& state, Groups first, Groups count);
    Status dispatchResolved(osg::State& state, Groups groups);
    Input& input(const std::string& uniform);

    std::string _name;
    std::vector<std::string> _defines;
    std::vector<Input> _inputs;
    std::vector<Output> _outputs;
    std::map<std::string, osg::ref_ptr<osg::Uniform>> _uniforms;
    std::map<unsigned, osg::ref_ptr<osg::UniformBufferBinding>> _blocks;
    std::map<unsigned, osg::ref_ptr<osg::ShaderStorageBufferBinding>> _storage;
    osg::ref_ptr<ComputeProgram> _program; ///< null before the first dispatch
    mutable std::set<unsigned> _contexts;  ///< that this pass uses it in
    osg::ref_ptr<osg::Uniform> _firstGroup =
        new osg::Uniform(osg::Uniform::UNSIGNED_INT_VEC3, "firstGroup");
};

/// Copies the GPU's content of a storage buffer into its array, which stays as it was where no pass
/// has used it yet. Needs a current context.
void readStorage(osg::State& state, osg::Array& values);

} // namespace osgTerrainLight
