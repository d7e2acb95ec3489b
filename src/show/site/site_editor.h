#pragma once
// Setting up the outputs in the dark: what a technician may ask for, and what becomes of the site.

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

// One thing that is asked for. Keyboard, mouse, hand controller and whatever comes later all end in
// these.
namespace edit {

enum class Tool { Corners, Mesh, Part, Masks, Light };

struct Output {  // the one `step` places further in the site's order
    int step = 1;
};
struct OutputNumber {
    std::size_t index = 0;
};
struct Choose {
    Tool tool = Tool::Corners;
};
struct NextTool {};
struct Handle {  // what is moved: the one `step` places further
    int step = 1;
};
struct Grasp {  // the handle nearest to a pixel of the chosen output
    glm::dvec2 pixel{0.0};
};
struct Move {  // in steps: right and down
    glm::dvec2 steps{0.0};
};
struct MoveTo {  // a pixel of the chosen output
    glm::dvec2 pixel{0.0};
};
struct Release {};  // key or button up: what comes next is undone by itself
struct StepSize {   // coarser, or below 0 finer
    int change = 1;
};
struct MeshPoints {  // 0: no mesh
    glm::ivec2 points{0};
};
struct AddMask {};   // in the middle of the picture; it is chosen
struct MaskPoints {  // one more behind the chosen point, or below 0 that one less; of the last three the mask goes
    int change = 1;
};
struct TurnMask {};  // hides what is outside of the chosen mask, or again what is inside
struct Flip {};      // none, horizontal, vertical, none ...
struct Turn {};      // by a quarter, clockwise
struct Reset {};     // the tool's values, as a site without them has them; masks that are pictures stay
struct Picture {     // on all outputs: the one `step` further
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

// A site while somebody sets its outputs up. Every state of it could be saved and loaded: what
// could not is refused and changes nothing, so that the last good picture stays on the wall.
// Thread: thread-bound.
class SiteEditor {
public:
    explicit SiteEditor(Site site);

    // Error: why not, and nothing has changed.
    Result<void> apply(const EditCommand& command);

    const Site& site() const { return site_; }
    std::size_t output() const { return output_; }
    edit::Tool tool() const { return tool_; }
    TestPicture picture() const { return picture_; }
    // Of the tool on the chosen output; never empty.
    std::vector<EditHandle> handles() const;
    std::size_t handle() const { return handle_; }
    // What is being edited, in words: output, tool and handle; its value and the step; what was not
    // saved.
    std::vector<std::string> lines() const;

    using Change = SiteChange;
    // What has changed since it was loaded or last saved, and the word that it was.
    std::vector<Change> unsaved() const;
    void saved();

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
    int step_ = 1;         // of kSteps: 0 is the coarsest
    bool moving_ = false;  // the next move belongs to the one before
    std::vector<Step> done_, undone_;
};

}  // namespace fantascope::show
