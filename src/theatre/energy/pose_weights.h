#pragma once

namespace fantascope::theatre {

// The weights of the energy's terms, named as in Won & Lee 2016, Table 1. The paper gives no units;
// here they are those of EnergyTerms. The defaults are the paper's for simple shapes.
struct PoseWeights {
    double w1 = 0.01, w2 = 0.005, w3 = 0.005;  // contour: points, normals, curvatures
    double w4 = 1000;                          // coverage
    double w5 = 5;                             // coherence
    double w6 = 0.1;                           // visible
    double w7 = 3, w8 = 0.001, w9 = 10;        // physics: floor, support area, margin
    double w10 = 0.04, w11 = 0.04;             // physics: penetration of people, of the stage set
    double w12 = 0.25;                         // hints
    double w13 = 300, w14 = 40;                // motion: difference from the adjacent frames, from the principal poses
    double w15 = 0.04, w16 = 100;              // contacts: places, rotations
};

// The terms of equations 1 to 11, unweighted. Units that the paper does not state are chosen so
// that its weights balance the terms.
struct EnergyTerms {
    double contourPoint = 0;      // (2) sum |p - p'|^2 over 200 points, in pixels of a target 256 pixels high
    double contourNormal = 0;     // (2) sum |n - n'|^2
    double contourCurvature = 0;  // (2) sum (k - k')^2, k in 1 / kDiscRadius
    double coverage = 0;          // (3) differing area, in areas of the target
    double coherence = 0;         // (4) changes of actor around the contour
    double visible = 0;           // (5) sum of squared metres; graded where the paper has infinity
    double floor = 0;             // (6) sum of heights above the floor, millimetres
    double supportArea = 0;       // (6) sum of the areas' shortfalls below kAmpleArea, square centimetres
    double margin = 0;            // (6) sum of lackOfMargin(), centimetres
    double people = 0;            // (6) sum of squared depths of bodies in themselves and in each other, square millimetres
    double stageSet = 0;  // (6) the same in floor, screens, platforms and props, and in distances outside the standing area
    double hint = 0;      // (7) sum of squared distances, pixels as in contourPoint
    // Of poses that move (continuity.h); 0 for stills.
    double smooth = 0, regular = 0;            // (8), (10) sums of poseDifference()
    double contactPlace = 0, contactTurn = 0;  // (11) sums of contactDrift()

    double contour(const PoseWeights& w) const { return w.w1 * contourPoint + w.w2 * contourNormal + w.w3 * contourCurvature; }
    // `stiffness`: a factor on all physics terms. The paper's balance corresponds to about 0.1 in
    // these units. A pose that a person can hold needs 1.
    double physics(const PoseWeights& w, double stiffness = 1) const {
        return stiffness * (w.w7 * floor + w.w8 * supportArea + w.w9 * margin + w.w10 * people + w.w11 * stageSet);
    }
    double motion(const PoseWeights& w) const {
        return w.w13 * smooth + w.w14 * regular + w.w15 * contactPlace + w.w16 * contactTurn;
    }
    double total(const PoseWeights& w, double stiffness = 1) const {
        return contour(w) + w.w4 * coverage + w.w5 * coherence + w.w6 * visible + physics(w, stiffness) + w.w12 * hint +
               motion(w);
    }
};

}  // namespace fantascope::theatre
