#include "app/programme.h"

#include "app/site_models.h"

#include "pattern/shape_pattern.h"

#include "core/image.h"

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;

// The pictures of a show's sources, and for each the drawing that it should read as; none for a solid.
struct Pictures {
    std::vector<render::PictureSource> sources;
    struct Guide {
        GreyImage drawing;  // stored values, as the pattern was compared with them
        double canvasAspect = 1;
    };
    std::vector<std::optional<Guide>> guides;
};

Result<Pictures> readPictures(const show::Show& show) {
    Pictures pictures;
    for (const show::Source& declared : show.sources) {
        if (const auto* solid = std::get_if<show::SolidSource>(&declared.picture)) {
            pictures.sources.emplace_back(render::SolidSource{solid->colour});
            pictures.guides.emplace_back();
            continue;
        }
        const fs::path& file = std::get<show::PatternSource>(declared.picture).file;
        render::PatternSource source = TRY(readPatternSource(file));
        const pattern::ShapePattern& pattern = *source.pattern;
        pictures.guides.push_back(Pictures::Guide{TRY(readGrey(pattern.guide).in(file.string() + ": guide")), pattern.aspect()});
        pictures.sources.emplace_back(std::move(source));
    }
    return pictures;
}

Result<std::vector<Watch::Comparisons>> compareWith(const std::vector<std::optional<Pictures::Guide>>& guides,
                                                    const show::Site& site) {
    std::vector<Watch::Comparisons> comparisons(site.outputs.size());
    for (std::size_t output = 0; output < site.outputs.size(); ++output)
        for (const auto& guide : guides) {
            std::optional<vision::NominalView> view;
            if (guide) view = TRY(nominalViewOf(site, output, guide->canvasAspect));
            comparisons[output].push_back(view ? std::make_shared<const vision::GuideComparison>(*view, guide->drawing)
                                               : nullptr);
        }
    return comparisons;
}

}  // namespace

Result<render::PatternSource> readPatternSource(const fs::path& file) {
    auto pattern = std::make_shared<const pattern::ShapePattern>(TRY(pattern::readPattern(file)));
    auto motion = std::make_shared<const pattern::PatternMotion>(*pattern);
    return render::PatternSource{std::move(pattern), std::move(motion)};
}

Result<Programme> readProgramme(const RunOptions& options) {
    Programme programme;
    programme.show = TRY(show::Show::load(options.show));
    programme.site = TRY(show::readSite(fs::is_directory(options.site) ? options.site / "site.yaml" : options.site));
    programme.cues = TRY(programme.show.bind(programme.site));
    if (!options.fromCue.empty()) {
        const std::size_t cue = TRY(programme.show.cueNamed(options.fromCue));
        programme.firstInput = show::Input{Time{}, show::Input::Kind::Jump, static_cast<int>(cue)};
    }
    Pictures pictures = TRY(readPictures(programme.show));
    programme.sources = std::move(pictures.sources);
    programme.comparisons = TRY(compareWith(pictures.guides, programme.site));
    return programme;
}

}  // namespace fantascope::app
