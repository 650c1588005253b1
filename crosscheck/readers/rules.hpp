// SPDX-License-Identifier: GPL-3.0-or-later
// The mistakes that readers of robot descriptions make: each is a way to read the same file, to be
// tried until one gives exactly what a reader has.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "crosscheck/readers/robot.hpp"
#include "scene/numbers.hpp"
#include "scene/urdf.hpp"

namespace dynwitness::crosscheck {

enum class Mistake {
  // of a link's inertia, R its <inertial> turn, I as written, c its centre of mass
  kInertialTurnDropped,     ///< I for R I R'
  kInertialTurnTransposed,  ///< R' I R
  kInertialTurnOneSide,     ///< the upper triangle of R I
  kInertialTurnOneSideLow,  ///< the lower triangle of R I
  kInertialTurnTwice,       ///< R R I R' R'
  kProductsDropped,
  kProductsNegated,
  kComTurned,      ///< R c
  kComTurnedBack,  ///< R' c
  kComDropped,
  kInertiaAboutJoint,    ///< I is about the link's origin: less m c^2
  kInertiaShiftedTwice,  ///< m c^2 added twice: I is about the com, and is taken for less
  kInertiaDropped,       ///< a point mass
  kBalanced,             ///< all moments the mean, where they break the triangle inequality
  kFromGeometry,         ///< that of its collision shapes, of water
  // of a link without <inertial>, or with a mass of zero
  kDefaultMass,              ///< 1 kg, 1 kg m^2 about each axis, at the link's origin
  kDefaultMassAlone,         ///< 1 kg at the link's origin
  kGeometryWithoutInertial,  ///< that of its collision shapes, of water
  // of a link that is fixed to another, X its placement
  kNotRotated,            ///< X without its turn
  kTensorNotRotated,      ///< the inertia's axes without it
  kComNotRotated,         ///< the centre of mass without it
  kRotatedBack,           ///< X with its turn transposed
  kNotShifted,            ///< X without its shift
  kShiftInPrincipalAxes,  ///< not rotated, and the shift p turned by its principal axes Q: c + Q p
  kMassDropped,           ///< nothing of it
  kComInParent,           ///< of any link: c seen from its parent's
  kParallelAxisMissing,
  kParallelAxisDoubled,
  kParallelAxisNegated,
};
/// "the <inertial> rpy is dropped"
const char* words(Mistake mistake);

/// Mistakes of the frame of a joint: its origin, on the way from the link that moves its parent.
enum class FrameMistake {
  kTurnDropped,
  kTurnTransposed,
  kTurnReversed,
  kShiftDropped,
  kShiftTurned
};
const char* words(FrameMistake mistake);

/** A file, taken apart: what each moving body is made of, and where its joint stands. Read by
    Eigen's turns in double, independently of the sweeps' own lumping. */
class FileParts {
 public:
  explicit FileParts(const scene::Urdf& urdf);
  /// Without shapes and limits, for any format.
  explicit FileParts(const scene::Mechanism& mechanism);

  /// The robot as it is.
  const Robot& robot() const { return robot_; }
  /// The line of a body's link in the file.
  const scene::SourceLocation& where(std::size_t body) const { return where_[body]; }

  /** A body's mass moments, read with mistakes: at all links of the body, or at one. */
  struct Slip {
    Mistake mistake;
    std::string link;  ///< empty: all
  };
  MassMoments read(std::size_t body, const std::vector<Slip>& slips) const;
  /// The same with mistakes at one link alone, by its place in links(): at no more than the cost of
  /// that link, but for mistakes of the parallel axis.
  MassMoments readAt(std::size_t body, std::size_t place, const std::vector<Mistake>& slips) const;
  /// Links of a body at which a mistake changes something, in the order of the file.
  std::vector<std::string> links(std::size_t body) const;

  /// Whether any link of a body has an <inertial> in the URDF.
  bool hasInertial(std::size_t body) const;

  /// A joint's place on its parent body, read with a mistake in each origin on the way.
  Eigen::Isometry3d readOrigin(std::size_t body, FrameMistake mistake) const;
  /// The axis as written, of whatever length; and the turn of the joint's origin.
  Eigen::Vector3d writtenAxis(std::size_t body) const { return axes_[body]; }
  Eigen::Matrix3d turnOfOrigin(std::size_t body) const;
  /// The sum of the shifts on that way [m].
  double reach(std::size_t body) const;

 private:
  struct Piece {
    std::string link;
    bool is_fixed, has_mass, has_inertial;
    Eigen::Isometry3d X;          ///< x_body = X x_link
    Eigen::Vector3d from_parent;  ///< the link's origin in its parent's link
    Eigen::Matrix3d turn_from_parent;
    double mass;
    Eigen::Vector3d com;
    Eigen::Matrix3d R, I;  ///< about the centre of mass
    std::vector<MassMoments> solids;
    MassMoments moments;  ///< in the body's frame
  };
  struct Origin {
    Eigen::Vector3d xyz, rpy;
    Eigen::Isometry3d X;
  };
  struct Draft;
  void build(const scene::Mechanism& mechanism, const std::vector<scene::UrdfPart>* parts);
  static std::vector<Origin> originsOf(const scene::Mechanism& mechanism, const scene::Link& link);
  static Piece pieceOf(const scene::Link& link, const scene::UrdfPart* part,
                       const Eigen::Isometry3d& X_before, const scene::RealNumbers<double>& number);
  static MassMoments readPiece(const Piece& piece, const std::vector<Slip>& slips,
                               double* parallel_axes);

  Robot robot_;
  std::vector<std::vector<Piece>> pieces_;    ///< by body
  std::vector<std::vector<Origin>> origins_;  ///< by body: from the parent body to the joint
  std::vector<Eigen::Vector3d> axes_;
  std::vector<scene::SourceLocation> where_;
};

/// A URDF as it is written, or MJCF, by our own readers.
/// @throws InputError  as they do
FileParts readParts(const std::string& text, const std::filesystem::path& file);

/// Whether two readings of a body are the same but for rounding and what the reader's principal
/// axes lose. slip: how far a reader that places all links in one frame may misplace this one [m].
bool isSame(const MassMoments& a, const MassMoments& b, int links, double unturned,
            double slip = 0);

/// "digits are lost: 7.2 are left" of a difference that is a small share of what is read and that
/// no mistake explains which is tried. Empty: none, no number, or one that leaves fewer than four
/// digits, half of float's, which is where we chose to call it no loss of digits.
std::string digitsLost(double share);

struct NamedMistakes {
  std::string words;  ///< "the rpy of <inertial> is dropped (link_3)"; empty: none that is tried
  std::vector<Mistake> mistakes;
};
/// The mistakes that turn the file into what a reader has of a body: one, or else two, at all of
/// its links or at one of them.
NamedMistakes explanation(const FileParts& file, std::size_t body, const MassMoments& seen,
                          double unturned);

/// A body read with one mistake.
struct MassReading {
  std::string words;
  Mistake mistake;
  MassMoments moments;
};
/// All of them that change something: at all links of the body, then at one.
std::vector<MassReading> misreadings(const FileParts& file, std::size_t body);
/// Two of them together, at all links or at one.
std::vector<MassReading> pairsOfMisreadings(const FileParts& file, std::size_t body);

/// A joint read with one mistake: its origin, its axis, its kind.
struct JointReading {
  const char* quantity;
  std::string words;
  ReadBody body;
};
/// All of them that change something, the plainest first.
std::vector<JointReading> jointMisreadings(const FileParts& file, std::size_t body);

/// How gravity was mistaken; empty: in no way that is known.
std::string gravityMistake(const Eigen::Vector3d& file, const Eigen::Vector3d& seen);

/// Where a reader of this name is on public record with a mistake; empty: not known.
std::string publicRecord(const std::string& reader, Mistake mistake);

}  // namespace dynwitness::crosscheck
