#pragma once
// Every subcommand of the program, each in a file of its own name.

#include "app/base/command.h"

namespace fantascope::app {

// `fantascope pattern GUIDE -o P.pattern.yaml`: finds a light pattern that reads as the artist's
// drawing. The pattern's folder holds everything that it needs: files from elsewhere are copied
// into it, as P.guide.png and P.NAME.obj.
void addPatternCommand(Program& program);
// `pose TARGET -o C.cast.yaml`: people whose shadow is a silhouette.
void addPoseCommand(Program& program);
// `deform SILHOUETTE --motion M.motion.yaml -o FOLDER`: a silhouette that moves with its handles.
void addDeformCommand(Program& program);
// `fantascope adapt`: principal poses follow a silhouette that moves.
void addAdaptCommand(Program& program);
// `fantascope fabricate`: a cast's poses as one solid that a printer makes, with a sheet to set up
// its lamp.
void addFabricateCommand(Program& program);
// `fantascope convert`: writes a cast's poses or motion as a scene for other programs.
void addConvertCommand(Program& program);
// fantascope rehearse [SHOW]: a show on the simulated site, in real time or as fast as possible.
void addRehearseCommand(Program& program);
// fantascope run SHOW --site SITE: a show on the devices that the site file names.
void addRunCommand(Program& program);
// `fantascope export SHOW --output NAME -o FILE|DIR`: writes an output's frames for other programs,
// as pictures with alpha or as a video. SHOW may be a single pattern. See docs/drawing.md.
void addExportCommand(Program& program);
// `fantascope template SITE --output NAME -o PNG`: draws the scene from the projector's point of
// view, as a picture to draw a guide over. See docs/drawing.md.
void addTemplateCommand(Program& program);
// `fantascope preview PATTERN --scene MESH -o PNG`: shows a pattern as a light mask projected on a
// 3D scene, as a picture or as a film of its movement. See docs/drawing.md.
void addPreviewCommand(Program& program);
// `fantascope plot PATTERN|REPORT|CAST -o PNG|SVG`: draws figures.
void addPlotCommand(Program& program);
// `fantascope report JOURNAL -o PAGE.html`: the audit of nights.
void addReportCommand(Program& program);
// `fantascope schedule SHOW --site SITE`: the season as a table.
void addScheduleCommand(Program& program);
// `fantascope schema show|site`: a JSON schema of the files, for editors.
void addSchemaCommand(Program& program);
// fantascope check PATH... [--site SITE]
void addCheckCommand(Program& program);
// `calibrate SITE [OUTPUT..]`: the outputs' warps, found with the camera.
void addCalibrateCommand(Program& program);
// `lens SITE`: the lens of the site's camera, found with a printed board; `lens --board` makes
// that.
void addLensCommand(Program& program);
// `fantascope devices`: lists devices that it finds, reports the state of a site's devices, or
// tries one of them.
void addDevicesCommand(Program& program);
void addGuardCommand(Program& program);

}  // namespace fantascope::app
