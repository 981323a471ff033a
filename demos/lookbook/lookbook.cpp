#include "demos/lookbook/lookbook.h"

#include <algorithm>
#include <filesystem>
#include <memory>

#include "data/body/body_shapes.h"
#include "data/body/outfit.h"
#include "data/files/make_folder.h"
#include "demos/compare/body_named.h"
#include "demos/lookbook/look.h"
#include "render/montage.h"
#include "render/osmesa_renderer.h"
#include "render/text.h"
#include "render/video.h"

namespace cloth {
namespace {

constexpr int width = 240, height = 400;  // of a panel (pixels)

std::vector<std::string> bodies_of(const LookbookOptions& options) {
    if (!options.bodies.empty()) return options.bodies;
    return BodyShapes::load_shared() ? body_names() : std::vector<std::string>{"default"};
}

/// What stands above a garment: of one's own, its file's name without folder and ending.
std::string heading_of(const std::string& garment) {
    std::string heading;
    for (const std::string& part : outfit_parts(garment))
        heading += (heading.empty() ? "" : "+") + std::filesystem::path(part).stem().string();
    return heading;
}

std::vector<std::string> headings_of(const LookbookOptions& options) {
    std::vector<std::string> headings;
    for (const std::string& garment : options.garments) headings.push_back(heading_of(garment));
    return headings;
}

/// All garments on one body, and the camera that follows it.
class Row {
 public:
    Row(const LookbookOptions& options, const std::string& body, OsmesaRenderer& renderer)
        : m_options(options),
          m_headings(headings_of(options)),
          m_body(body),
          m_renderer(renderer),
          m_tracker(tracker()) {
        for (const std::string& garment : options.garments) {
            BodySceneSettings settings;
            settings.garment = garment;
            settings.body = body;
            settings.motion = options.motion;
            settings.frames = options.frames;
            settings.limbs = true;
            m_looks.push_back(std::make_unique<Look>(settings, options.solver, options.threads));
        }
    }

    const std::vector<std::unique_ptr<Look>>& looks() const { return m_looks; }
    int frames() const { return m_looks.front()->frames(); }

    /// By a camera that frames the figure as it is now.
    std::vector<Image> portraits() const {
        return panels(tracker().follow(m_looks.front()->skin()));
    }

    std::vector<Image> panels(const Camera& camera) const {
        std::vector<Image> panels;
        for (size_t k = 0; k < m_looks.size(); ++k)
            panels.push_back(m_renderer.render(m_looks[k]->picture(k), camera));
        return panels;
    }

    void settle(const ProgressFunction& progress) {
        for (size_t k = 0; k < m_looks.size(); ++k) {
            m_looks[k]->settle();
            progress(static_cast<int>(k) + 1, static_cast<int>(m_looks.size()),
                     m_body + ": settles");
        }
    }

    /// @return  the panels of the frame for the picture
    std::vector<Image> run(const ProgressFunction& progress) {
        const int shown = std::min(m_options.picture, frames() - 1);
        std::vector<Image> picture;
        std::unique_ptr<VideoWriter> video;
        for (int frame = 0; frame < frames(); ++frame) {
            for (const auto& look : m_looks) look->step();
            if (m_options.video)
                add(video, montage(panels(m_tracker.follow(m_looks.front()->skin())), m_headings));
            if (frame == shown) picture = portraits();
            progress(frame + 1, frames(), m_body + ": frames");
        }
        if (video) video->close();
        return picture;
    }

 private:
    static FigureTracker tracker() {
        return FigureTracker(FramingSettings{}, static_cast<double>(width) / height);
    }

    void add(std::unique_ptr<VideoWriter>& video, const Image& image) const {
        if (!video)
            video = std::make_unique<VideoWriter>(m_options.out + "/" + m_body + ".mp4",
                                                  image.width(), image.height());
        video->add(image);
    }

    const LookbookOptions& m_options;
    std::vector<std::string> m_headings;
    std::string m_body;
    OsmesaRenderer& m_renderer;
    FigureTracker m_tracker;
    std::vector<std::unique_ptr<Look>> m_looks;
};

/// The rows below each other, a column for each garment.
class Page {
 public:
    explicit Page(const LookbookOptions& options) : m_options(options) {}

    void add(const std::string& row, const std::vector<Image>& panels) {
        m_panels.insert(m_panels.end(), panels.begin(), panels.end());
        // The body's name stays whole: it is what tells the rows apart.
        const std::string end = ", " + row;
        const int room = width - text_height - m_font.measure(end, text_height).width;
        for (const std::string& heading : headings_of(m_options))
            m_captions.push_back(m_font.shortened(heading, text_height, room) + end);
    }

    void write() const {
        MontageSettings settings;
        settings.columns = static_cast<int>(m_options.garments.size());
        settings.caption_height = text_height;
        write_png(m_options.out + "/lookbook.png", montage(m_panels, m_captions, settings));
    }

 private:
    static constexpr int text_height = 14;  // of the captions (pixels)

    const LookbookOptions& m_options;
    Font m_font;
    std::vector<Image> m_panels;
    std::vector<std::string> m_captions;
};

}  // namespace

nlohmann::ordered_json make_lookbook(const LookbookOptions& options,
                                     const ProgressFunction& progress) {
    make_folder(options.out);
    OsmesaSettings sizes;
    sizes.width = width;
    sizes.height = height;
    OsmesaRenderer renderer(sizes);
    Page page(options);
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const std::string& body : bodies_of(options)) {
        Row row(options, body, renderer);
        row.settle(progress);
        if (rows.empty()) page.add("at the start", row.portraits());
        page.add(body, row.run(progress));
        page.write();
        for (const auto& look : row.looks()) rows.push_back(look->measured());
    }
    return rows;
}

}  // namespace cloth
