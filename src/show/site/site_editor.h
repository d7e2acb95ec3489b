#pragma once
// Setting up the outputs in the dark: the technician's commands, and the site that results.

#include "show/site/mask_handles.h"
#include "show/site/projection_changes.h"
#include "show/site/site.h"

#include "core/config/config_edit.h"
#include "core/result.h"
#include "media/projection.h"

#include <glm/vec2.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace fantascope::show {

// The commands. Keyboard, mouse and hand controller all give these.
namespace edit {

enum class Tool { Corners, Mesh, Part, Masks, Light };

struct Output {  // choose the output `step` places further in the site's order
    int step = 1;
};
struct OutputNumber {
    std::size_t index = 0;
};
struct Choose {
    Tool tool = Tool::Corners;
};
struct NextTool {};
struct Handle {  // choose the handle `step` places further
    int step = 1;
};
struct Grasp {  // choose the handle nearest to a pixel of the chosen output
    glm::dvec2 pixel{0.0};
};
struct Move {  // move the handle by steps, right and down
    glm::dvec2 steps{0.0};
};
struct MoveTo {  // move the handle to a pixel of the chosen output
    glm::dvec2 pixel{0.0};
};
struct Release {};  // key or button up: the next move is undone separately
struct StepSize {   // make the steps coarser; negative: finer
    int change = 1;
};
struct MeshPoints {  // 0: no mesh
    glm::ivec2 points{0};
};
struct AddMask {};   // add a mask in the middle of the picture, and choose it
struct MaskPoints {  // add a point behind the chosen one; negative: remove the chosen one, or a mask of three points
    int change = 1;
};
struct TurnMask {};  // toggle the side that the chosen mask hides: inside or outside
struct Flip {};      // none, horizontal, vertical, none ...
struct Turn {};      // by a quarter, clockwise
struct Reset {};     // set the tool's values to their defaults; masks that are images stay
struct Picture {     // show the test picture `step` places further, on all outputs
    int step = 1;
};
struct Show {
    TestPicture picture = TestPicture::None;
};
struct Undo {};
struct Redo {};

}  // namespace edit
using EditCommand =
    std::variant<edit::Output, edit::OutputNumber, edit::Choose, edit::NextTool, edit::Handle, edit::Grasp, edit::Move,
                 edit::MoveTo, edit::Release, edit::StepSize, edit::MeshPoints, edit::AddMask, edit::MaskPoints, edit::TurnMask,
                 edit::Flip, edit::Turn, edit::Reset, edit::Picture, edit::Show, edit::Undo, edit::Redo>;

// A site while its outputs are set up. Every state of it can be saved and loaded. A command that
// would break this is refused and changes nothing, so that the last good picture stays on the wall.
// Thread: thread-bound.
class SiteEditor {
public:
    explicit SiteEditor(Site site);

    // Carries out a command. Error: why not; nothing has changed.
    Result<void> apply(const EditCommand& command);

    const Site& site() const { return site_; }
    std::size_t output() const { return output_; }
    edit::Tool tool() const { return tool_; }
    TestPicture picture() const { return picture_; }
    // The handles of the tool on the chosen output; never empty.
    std::vector<EditHandle> handles() const;
    std::size_t handle() const { return handle_; }
    // The editor's state in words, in three lines: output, tool and handle; value and step; saved
    // or not saved.
    std::vector<std::string> lines() const;

    using Change = SiteChange;
    // The changes since the site was loaded or last saved.
    std::vector<Change> unsaved() const;
    // Call this when the changes have been saved.
    void saved();
    // Continues from projections that somebody else has saved, one for each output. What was done
    // before cannot be undone any more.
    void adopt(const std::vector<Projection>& projections);

private:
    struct Step {
        std::size_t output;
        Projection before;
    };
    Projection& projection() { return site_.outputs[output_].projection; }
    const Projection& projection() const { return site_.outputs[output_].projection; }
    std::size_t handleCount() const;
    Result<void> change(Projection wanted, bool moves);
    Result<void> moveBy(glm::dvec2 pixelsOrSteps, bool pixels);
    void swapWith(std::vector<Step>& from, std::vector<Step>& to);

    Result<void> run(const edit::Output&);
    Result<void> run(const edit::OutputNumber&);
    Result<void> run(const edit::Choose&);
    Result<void> run(const edit::NextTool&);
    Result<void> run(const edit::Handle&);
    Result<void> run(const edit::Grasp&);
    Result<void> run(const edit::Move&);
    Result<void> run(const edit::MoveTo&);
    Result<void> run(const edit::Release&);
    Result<void> run(const edit::StepSize&);
    Result<void> run(const edit::MeshPoints&);
    Result<void> run(const edit::AddMask&);
    Result<void> run(const edit::MaskPoints&);
    Result<void> run(const edit::TurnMask&);
    Result<void> run(const edit::Flip&);
    Result<void> run(const edit::Turn&);
    Result<void> run(const edit::Reset&);
    Result<void> run(const edit::Picture&);
    Result<void> run(const edit::Show&);
    Result<void> run(const edit::Undo&);
    Result<void> run(const edit::Redo&);

    Site site_;
    std::vector<Projection> saved_;
    std::size_t output_ = 0, handle_ = 0;
    edit::Tool tool_ = edit::Tool::Corners;
    TestPicture picture_ = TestPicture::None;
    int step_ = 1;         // the step size: 0 is the coarsest
    bool moving_ = false;  // the next move is undone together with the previous one
    std::vector<Step> done_, undone_;
};

}  // namespace fantascope::show
