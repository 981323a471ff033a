// Reader of BVH files (Biovision hierarchy: joint tree, then one row of channel values per frame).
//
// Why not assimp's importer: it reads the frames as one stream of tokens, so a row with a missing
// value silently shifts every value after it; it takes "nan" for a number, knows no line numbers,
// and drops the difference between a joint's position channels and its offset. The tests use it as
// the oracle for valid files.

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <sstream>

#include "data/body/motion.h"
#include "data/core/check_range.h"
#include "data/core/errors.h"
#include "data/core/printable.h"
#include "data/core/read_file.h"

namespace cloth {

namespace {

constexpr double degree = M_PI / 180.0;
constexpr double farthest = 1e6;        // m
constexpr double longest_offset = 1e9;  // in the file's units, which are a millimetre at least

enum class Channel { x_position, y_position, z_position, x_rotation, y_rotation, z_rotation };

constexpr const char* channel_names[] = {"Xposition", "Yposition", "Zposition",
                                         "Xrotation", "Yrotation", "Zrotation"};

/// The lines of a file, split into words; knows where it is for error messages.
class LineReader {
 public:
    explicit LineReader(const std::string& path) : m_path(path), m_stream(read_text_file(path)) {}

    /// Words of the next line that is not blank; false at the end of the file.
    bool next(std::vector<std::string>& words) {
        std::string line;
        while (std::getline(m_stream, line)) {
            ++m_line;
            std::istringstream split(line);
            words.assign(std::istream_iterator<std::string>(split), {});
            if (!words.empty()) return true;
        }
        return false;
    }

    std::vector<std::string> require(const std::string& expected) {
        std::vector<std::string> words;
        if (!next(words)) fail("the file ends where " + expected + " should follow", truncated);
        return words;
    }

    [[noreturn]] void fail(const std::string& problem, const std::string& remedy) const {
        throw LoadError(m_path, "line " + std::to_string(m_line), printable(problem), remedy);
    }

    double number(const std::string& word) const {
        char* end = nullptr;
        const double value = std::strtod(word.c_str(), &end);
        if (end == word.c_str() || *end != '\0' || !std::isfinite(value))
            fail("'" + word + "' is not a finite number", "export the motion again");
        return value;
    }

    static constexpr const char* truncated = "the file is truncated: copy or download it again";

 private:
    std::string m_path;
    std::istringstream m_stream;
    int m_line = 0;
};

struct JointChannels {
    int joint;
    std::vector<Channel> channels;
};

struct Hierarchy {
    std::vector<std::string> names;
    std::vector<int> parents;
    std::vector<Vec3> offsets, end_offsets;
    std::vector<JointChannels> channels;
    size_t channel_count = 0;
};

Vec3 parse_offset(const LineReader& reader, const std::vector<std::string>& words) {
    if (words.size() != 4)
        reader.fail("OFFSET needs three numbers", "write 'OFFSET x y z' in the parent's frame");
    const Vec3 offset(reader.number(words[1]), reader.number(words[2]), reader.number(words[3]));
    if (offset.cwiseAbs().maxCoeff() > longest_offset)
        reader.fail("the OFFSET is out of range", "use numbers of at most 1e9");
    return offset;
}

Channel parse_channel(const LineReader& reader, const std::string& word) {
    for (int i = 0; i < 6; ++i)
        if (word == channel_names[i]) return static_cast<Channel>(i);
    reader.fail("unknown channel '" + word + "'",
                "channels are Xposition, Yposition, Zposition, Xrotation, Yrotation, Zrotation");
}

JointChannels parse_channels(const LineReader& reader, const std::vector<std::string>& words,
                             int joint) {
    JointChannels result{joint, {}};
    const double count = words.size() > 1 ? reader.number(words[1]) : -1.0;
    if (count != static_cast<double>(words.size()) - 2.0)
        reader.fail("CHANNELS announces another number of channels than it names",
                    "write 'CHANNELS n' followed by n names");
    for (size_t i = 2; i < words.size(); ++i)
        result.channels.push_back(parse_channel(reader, words[i]));
    return result;
}

int add_joint(Hierarchy& tree, const LineReader& reader, const std::string& name, int parent) {
    for (const std::string& other : tree.names)
        if (other == name)
            reader.fail("a second joint is called '" + name + "'", "give each joint its own name");
    tree.names.push_back(name);
    tree.parents.push_back(parent);
    tree.offsets.emplace_back(Vec3::Zero());
    tree.end_offsets.emplace_back(Vec3::Zero());
    return static_cast<int>(tree.names.size()) - 1;
}

void expect_brace(LineReader& reader) {
    const std::vector<std::string> words = reader.require("'{'");
    if (words.size() != 1 || words[0] != "{")
        reader.fail("'" + words[0] + "' stands where '{' should", "open the joint with '{'");
}

void parse_end_site(LineReader& reader, Hierarchy& tree, int joint) {
    expect_brace(reader);
    const std::vector<std::string> words = reader.require("OFFSET");
    if (words[0] != "OFFSET") reader.fail("an End Site holds OFFSET only", "remove the line");
    tree.end_offsets[joint] = parse_offset(reader, words);
    if (reader.require("'}'")[0] != "}")
        reader.fail("an End Site holds OFFSET only", "close it with '}'");
}

/// Reads the joint tree up to the line MOTION. Recursion is unrolled into a stack of open joints.
Hierarchy parse_hierarchy(LineReader& reader) {
    Hierarchy tree;
    std::vector<int> open;
    while (true) {
        const std::vector<std::string> words = reader.require("a joint or MOTION");
        const std::string& key = words[0];
        const bool names_joint =
            (key == "ROOT" && tree.names.empty()) || (key == "JOINT" && !open.empty());
        if (names_joint) {
            if (words.size() != 2) reader.fail(key + " needs one name", "write '" + key + " Name'");
            open.push_back(add_joint(tree, reader, words[1], open.empty() ? -1 : open.back()));
            expect_brace(reader);
        } else if (key == "End" && !open.empty()) {
            parse_end_site(reader, tree, open.back());
        } else if (key == "OFFSET" && !open.empty()) {
            tree.offsets[open.back()] = parse_offset(reader, words);
        } else if (key == "CHANNELS" && !open.empty()) {
            tree.channels.push_back(parse_channels(reader, words, open.back()));
            tree.channel_count += tree.channels.back().channels.size();
        } else if (key == "}" && !open.empty()) {
            open.pop_back();
        } else if (key == "MOTION" && open.empty() && !tree.names.empty()) {
            return tree;
        } else {
            reader.fail("unexpected '" + key + "'",
                        "the hierarchy is one ROOT of JOINT, OFFSET, CHANNELS, End Site and "
                        "balanced braces, then MOTION");
        }
    }
}

int parse_frame_count(LineReader& reader) {
    const std::vector<std::string> words = reader.require("'Frames: n'");
    if (words.size() != 2 || words[0] != "Frames:")
        reader.fail("'Frames: n' is missing", "write it after MOTION");
    const double count = reader.number(words[1]);
    if (count == 0.0) reader.fail("the motion has no frames", "use a file with at least one frame");
    if (count < 1 || count > 1e7 || count != std::floor(count))
        reader.fail("the number of frames, '" + words[1] + "', is out of range",
                    "write how many rows follow, a whole number from 1 to 10,000,000");
    return static_cast<int>(count);
}

double parse_frame_time(LineReader& reader) {
    const std::vector<std::string> words = reader.require("'Frame Time: s'");
    if (words.size() != 3 || words[0] != "Frame" || words[1] != "Time:")
        reader.fail("'Frame Time: s' is missing", "write it after 'Frames: n'");
    const double time = reader.number(words[2]);
    if (time <= 0.0) reader.fail("the frame time is not positive", "write it in seconds");
    // Resampling makes frames of 1/30 s: a time in other units would make millions of them.
    if (time > 10.0) reader.fail("the frame time is above 10 s", "write it in seconds");
    return time;
}

/// One row beyond the announced number is left alone: Boxing_Toes has one, as have other files.
/// More of them are a motion of which most would be missing.
void refuse_more_rows(LineReader& reader, int frame_count) {
    int more = 0;
    for (std::vector<std::string> words; reader.next(words);) ++more;
    if (more > 1)
        reader.fail("the file has " + std::to_string(frame_count + more) + " rows for " +
                        std::to_string(frame_count) + " frames",
                    "write the number of rows after 'Frames:', or remove those beyond it");
}

/// Channels apply from the left: R = R_first R_second R_third, acting on column vectors.
void apply_channel(Channel channel, double value, Vec3& position, Eigen::Quaterniond& rotation) {
    const int index = static_cast<int>(channel);
    if (index < 3)
        position[index] = value;
    else
        rotation = rotation * Eigen::AngleAxisd(value * degree, Vec3::Unit(index - 3));
}

MotionFrame parse_frame(const LineReader& reader, const Hierarchy& tree,
                        const std::vector<std::string>& words, double scale) {
    if (words.size() != tree.channel_count)
        reader.fail("the row has " + std::to_string(words.size()) + " values for " +
                        std::to_string(tree.channel_count) + " channels",
                    "each frame is one row with a value per channel");
    MotionFrame frame;
    frame.root_position = tree.offsets[0];
    frame.rotations.assign(tree.names.size(), Eigen::Quaterniond::Identity());
    size_t next = 0;
    for (const JointChannels& joint : tree.channels) {
        Vec3 ignored = Vec3::Zero();  // translations of inner joints: bones keep their length
        Vec3& position = joint.joint == 0 ? frame.root_position : ignored;
        for (Channel channel : joint.channels)
            apply_channel(channel, reader.number(words[next++]), position,
                          frame.rotations[joint.joint]);
    }
    frame.root_position *= scale;
    if (frame.root_position.cwiseAbs().maxCoeff() > farthest)
        reader.fail("the root is more than 1,000 km from the origin",
                    "export the motion again, or remove the row");
    for (Eigen::Quaterniond& rotation : frame.rotations) rotation.normalize();
    return frame;
}

Skeleton make_skeleton(const Hierarchy& tree) {
    Skeleton skeleton{tree.names, tree.parents, {}, {}};
    const auto count = static_cast<Eigen::Index>(tree.names.size());
    skeleton.offsets.resize(count, 3);
    skeleton.end_offsets.resize(count, 3);
    for (Eigen::Index j = 0; j < count; ++j) {
        skeleton.offsets.row(j) = tree.offsets[j];
        skeleton.end_offsets.row(j) = tree.end_offsets[j];
    }
    return skeleton;
}

/// Height of the figure in its rest pose, in file units.
double rest_height(const Skeleton& skeleton) {
    MotionFrame rest;
    rest.rotations.assign(skeleton.joint_count(), Eigen::Quaterniond::Identity());
    const Points joints = joint_positions(skeleton, rest);
    const Points ends = joints + skeleton.end_offsets;
    return std::max(joints.col(1).maxCoeff(), ends.col(1).maxCoeff()) -
           std::min(joints.col(1).minCoeff(), ends.col(1).minCoeff());
}

double detect_scale(const Skeleton& skeleton) {
    constexpr double standing = 1.6;  // m
    constexpr double units[] = {1.0, 0.056444, 0.0254, 0.01, 0.001};
    const double height = rest_height(skeleton);
    double best = 1.0;
    for (double unit : units)
        if (std::abs(std::log(unit * height / standing)) <
            std::abs(std::log(best * height / standing)))
            best = unit;
    return best;
}

double largest_turn(const MotionFrame& a, const MotionFrame& b) {
    double largest = 0.0;
    for (size_t j = 0; j < a.rotations.size(); ++j)
        largest = std::max(largest, a.rotations[j].angularDistance(b.rotations[j]));
    return largest;
}

/// A T-pose before the captured motion: most joints are exactly at zero, and the step to the next
/// frame is far larger than the motion's own.
bool starts_with_calibration(const Motion& motion) {
    if (motion.frame_count() < 3) return false;
    const std::vector<Eigen::Quaterniond>& first = motion.frames[0].rotations;
    int at_zero = 0;
    for (const Eigen::Quaterniond& rotation : first)
        at_zero += rotation.angularDistance(Eigen::Quaterniond::Identity()) < 1e-6;
    const double jump = largest_turn(motion.frames[0], motion.frames[1]);
    const double step = largest_turn(motion.frames[1], motion.frames[2]);
    return at_zero >= 0.6 * static_cast<double>(first.size()) && jump > 30.0 * degree &&
           jump > 3.0 * step;
}

void drop_calibration(Motion& motion, FirstFrame policy) {
    const bool drop = policy == FirstFrame::drop ||
                      (policy == FirstFrame::detect && starts_with_calibration(motion));
    if (!drop) return;
    if (motion.frame_count() == 1)
        throw LoadError(motion.source, "frame 0", "only the calibration pose is left to drop",
                        "use FirstFrame::keep");
    motion.frames.erase(motion.frames.begin());
}

}  // namespace

Motion load_bvh(const std::string& path, const BvhSettings& settings) {
    check_range("BvhSettings.scale", settings.scale, 0.0, 1e3);
    LineReader reader(path);
    std::vector<std::string> words;
    if (!reader.next(words)) reader.fail("the file is empty", LineReader::truncated);
    if (words[0] != "HIERARCHY")
        reader.fail("the file does not begin with HIERARCHY", "use a BVH file");
    const Hierarchy tree = parse_hierarchy(reader);

    Motion motion;
    motion.source = path;
    motion.name = std::filesystem::path(path).stem().string();
    motion.skeleton = make_skeleton(tree);
    const double scale = settings.scale > 0.0 ? settings.scale : detect_scale(motion.skeleton);
    motion.skeleton.offsets *= scale;
    motion.skeleton.end_offsets *= scale;

    const int frame_count = parse_frame_count(reader);
    motion.frame_time = parse_frame_time(reader);
    while (motion.frame_count() < frame_count) {
        if (!reader.next(words))
            reader.fail("the file ends after " + std::to_string(motion.frame_count()) + " of " +
                            std::to_string(frame_count) + " frames",
                        LineReader::truncated);
        motion.frames.push_back(parse_frame(reader, tree, words, scale));
    }
    refuse_more_rows(reader, frame_count);
    drop_calibration(motion, settings.first_frame);
    return motion;
}

}  // namespace cloth
