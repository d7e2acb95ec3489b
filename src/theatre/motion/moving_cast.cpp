#include "theatre/motion/moving_cast.h"

#include "theatre/deform/silhouette_sequence.h"

namespace fantascope::theatre {

Result<bool> loops(const Cast& cast) {
    if (!cast.sequence) return false;
    const SilhouetteSequence sequence = TRY(readSequence(cast.sequence->file));
    return sequence.loops && sequence.pictures.size() == cast.actors.front().poses.size();
}

MovingCast::MovingCast(const Cast& cast, bool loops) : cast_(cast), posed_(cast.actors.size()), held_(cast.actors.size()) {
    for (const Cast::Actor& actor : cast.actors) bodies_.push_back(humanBody(actor.stature));
    for (std::size_t i = 0; i < bodies_.size(); ++i) splines_.emplace_back(bodies_[i], cast.stage, cast.actors[i].poses, loops);
    pose(0);
}

void MovingCast::pose(double frame) {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        posed_[i].pose(bodies_[i], splines_[i].at(frame));
        placeHeld(cast_.stage, i, bodies_[i], posed_[i], held_[i]);
    }
}

}  // namespace fantascope::theatre
