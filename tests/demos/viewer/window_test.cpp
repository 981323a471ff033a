// The viewer in a real window: a mouse is moved, and pixels are looked at.
#include <gtest/gtest.h>

#include <memory>

#include "tests/demos/viewer/desktop.h"

namespace cloth::viewer_window_test {

using namespace test;

namespace {

constexpr int width = 900, height = 640, panel = 312;

/// Part of the pixels right of the panel that `is_so`.
template <typename Condition>
double share_of(const Image& image, const Condition& is_so) {
    int count = 0;
    for (int y = 0; y < image.height(); ++y)
        for (int x = panel; x < image.width(); ++x) count += is_so(x, y) ? 1 : 0;
    return static_cast<double>(count) / ((image.width() - panel) * image.height());
}

bool is_garment(Rgb colour) {
    return colour.b > colour.r + 30;  // it is blue
}
bool is_skin(Rgb colour) {
    return colour.r > colour.b + 20;
}

double garment_share(const Image& image) {
    return share_of(image, [&](int x, int y) { return is_garment(image.at(x, y)); });
}
double skin_share(const Image& image) {
    return share_of(image, [&](int x, int y) { return is_skin(image.at(x, y)); });
}
double changed_share(const Image& a, const Image& b) {
    return share_of(a, [&](int x, int y) { return a.at(x, y) != b.at(x, y); });
}
/// Garment in `a`, or in `b`, but not in both.
double moved_share(const Image& a, const Image& b) {
    return share_of(a,
                    [&](int x, int y) { return is_garment(a.at(x, y)) != is_garment(b.at(x, y)); });
}

struct Pixel {
    int x, y;
};

/// A pixel of the garment just above its lowest one.
Pixel hem(const Image& image) {
    for (int y = image.height() - 1; y >= 0; --y)
        for (int x = panel; x < image.width(); ++x)
            if (is_garment(image.at(x, y)) && is_garment(image.at(x, y - 8))) return {x, y - 8};
    return {0, 0};
}

class ViewerWindow : public testing::Test {
 protected:
    void SetUp() override {
        if (!Desktop::is_installed())
            GTEST_SKIP() << "there is no Xvfb or no xdotool: `apt-get install xvfb xdotool` brings "
                            "them";
        m_desktop = std::make_unique<Desktop>(width, height);
    }

    /// The viewer with a T-shirt of 1,000 vertices.
    void launch(std::vector<std::string> options) {
        std::vector<std::string> command = {
            VIEWER,     "--garment",           "tshirt_1000", "--width", std::to_string(width),
            "--height", std::to_string(height)};
        command.insert(command.end(), options.begin(), options.end());
        m_viewer = std::make_unique<ChildProgram>(
            command, m_folder.file("viewer.txt"),
            std::vector<std::string>{"DISPLAY=" + m_desktop->display(), "OMP_NUM_THREADS=1"});
    }

    /// The same; returns when it is shown.
    void start(std::vector<std::string> options) {
        launch(std::move(options));
        desktop().move(width - 30, 30);
        ASSERT_TRUE(becomes_true([&] { return !runs() || garment_share(screen()) > 0.01; }));
        ASSERT_TRUE(runs()) << content_of(m_folder.file("viewer.txt"));
    }

    const Desktop& desktop() const { return *m_desktop; }
    Image screen() const { return m_desktop->screen(); }
    bool runs() { return m_viewer->is_running(); }
    int status() { return m_viewer->wait(); }
    std::string file(const std::string& name) const { return m_folder.file(name); }

    std::string title() const {
        return desktop().xdotool("search --onlyvisible --name 'viewer: ' getwindowname");
    }

    /// The next picture that does not change any more.
    Image still_screen() {
        Image last = screen();
        const bool still = becomes_true([&] {
            wait_seconds(0.7);
            const Image now = screen();
            const bool equal = moved_share(last, now) < 2e-4;
            last = now;
            return equal;
        });
        EXPECT_TRUE(still);
        return last;
    }

    /// The body holds its first pose, and the shirt has come to rest on it.
    Image resting_shirt() {
        start({"--solver", "xpbd-10", "--paused"});
        desktop().click(20, 38);  // "body moves"
        desktop().click(50, 17);  // "Play"
        desktop().move(width - 30, 30);
        wait_seconds(1.0);
        return still_screen();
    }

 private:
    TemporaryFolder m_folder;
    std::unique_ptr<Desktop> m_desktop;
    std::unique_ptr<ChildProgram> m_viewer;
};

}  // namespace

TEST_F(ViewerWindow, ShowsBodyGarmentAndPanel) {
    start({"--paused"});
    const Image image = screen();
    EXPECT_GT(garment_share(image), 0.02);
    EXPECT_GT(skin_share(image), 0.02);
    EXPECT_LT(garment_share(image) + skin_share(image), 0.5);
    const Rgb corner = image.at(5, height - 5);
    EXPECT_LT(corner.r + corner.g + corner.b, 150) << "the panel is dark";
    EXPECT_NE(title().find("tshirt_1000"), std::string::npos) << title();
}

TEST_F(ViewerWindow, AMouseBesideTheFigureTurnsTheCameraAndTheWheelBringsItNearer) {
    start({"--paused"});
    const Image before = still_screen();
    desktop().drag(width - 40, 60, width - 240, 60);
    EXPECT_TRUE(becomes_true([&] { return changed_share(before, screen()) > 0.05; }));
    desktop().release();
    const Image turned = still_screen();
    EXPECT_GT(garment_share(turned), 0.01) << "the figure stays in the middle";
    for (int k = 0; k < 4; ++k) desktop().xdotool("click 4");
    EXPECT_TRUE(
        becomes_true([&] { return garment_share(screen()) > 1.3 * garment_share(turned); }));
    EXPECT_TRUE(runs());
}

TEST_F(ViewerWindow, PauseStopsItAndPlayGoesOn) {
    start({"--solver", "xpbd-10"});
    const Image first = screen();
    EXPECT_TRUE(becomes_true([&] { return changed_share(first, screen()) > 0.01; }));
    desktop().key("space");
    wait_seconds(2.0);
    const Image paused = screen();
    wait_seconds(1.5);
    EXPECT_EQ(changed_share(paused, screen()), 0.0);
    desktop().key("space");
    EXPECT_TRUE(becomes_true([&] { return changed_share(paused, screen()) > 0.01; }));
    EXPECT_TRUE(runs());
}

TEST_F(ViewerWindow, ASingleStepIsOne) {
    start({"--solver", "xpbd-10", "--paused"});
    const Image before = still_screen();
    desktop().key("n");
    EXPECT_TRUE(becomes_true([&] { return changed_share(before, screen()) > 1e-3; }));
    wait_seconds(1.0);
    const Image after = screen();
    wait_seconds(1.0);
    EXPECT_EQ(changed_share(after, screen()), 0.0);
}

TEST_F(ViewerWindow, ClothThatIsDraggedMovesAndFallsBack) {
    const Image before = resting_shirt();
    const Pixel grip = hem(before);
    ASSERT_GT(grip.y, 0);
    const auto below = [&](const Image& image) {
        return share_of(
            image, [&](int x, int y) { return y > grip.y + 12 && is_garment(image.at(x, y)); });
    };
    EXPECT_LT(below(before), 1e-4);
    desktop().drag(grip.x, grip.y, grip.x, grip.y + 70);
    EXPECT_TRUE(becomes_true([&] { return below(screen()) > 1e-3; })) << "it follows the mouse";
    desktop().release();
    EXPECT_TRUE(becomes_true([&] { return below(screen()) < 5e-4; })) << "it falls back";
    EXPECT_TRUE(runs());
}

TEST_F(ViewerWindow, TheSolverIsSwitchedByThePanel) {
    start({"--solver", "xpbd-10"});
    EXPECT_TRUE(becomes_true([&] { return title().find("xpbd-10") != std::string::npos; }))
        << title();
    desktop().click(80, 164);  // the list of solvers
    desktop().click(60, 190);  // its first one
    EXPECT_TRUE(becomes_true([&] { return title().find("quasi-newton") != std::string::npos; }))
        << title();
    const Image first = screen();
    EXPECT_TRUE(becomes_true([&] { return changed_share(first, screen()) > 0.01; }))
        << "it goes on";
    EXPECT_GT(garment_share(screen()), 0.01);
    EXPECT_TRUE(runs());
}

TEST_F(ViewerWindow, AnotherGarmentIsPutOnByThePanel) {
    start({"--solver", "xpbd-10"});
    desktop().click(80, 80);   // the list of garments
    desktop().click(60, 106);  // its first one
    EXPECT_TRUE(becomes_true([&] {
        return title().find("tshirt_1000+pants_1000, xpbd-10") != std::string::npos;
    })) << title();
    const Image first = screen();
    EXPECT_TRUE(becomes_true([&] { return changed_share(first, screen()) > 0.01; }));
    EXPECT_TRUE(runs());
}

TEST_F(ViewerWindow, WritesAScreenshotAfterSoManySteps) {
    // It may end before anybody has seen it.
    launch({"--solver", "xpbd-10", "--frames", "12", "--colours", "stretch", "--wireframe",
            "--screenshot", file("shirt.png")});
    EXPECT_EQ(status(), 0);
    const Image image = read_png(file("shirt.png"));
    EXPECT_EQ(image.width(), width);
    EXPECT_EQ(image.height(), height);
    EXPECT_GT(skin_share(image), 0.02);
}

TEST_F(ViewerWindow, ClosesByAKey) {
    start({"--paused"});
    desktop().key("Escape");
    EXPECT_TRUE(becomes_true([&] { return !runs(); }));
    EXPECT_EQ(status(), 0);
}

TEST(ViewerWithoutDisplay, NeitherDoesItOpenAWindowWithoutOpenGl) {
    if (!Desktop::is_installed()) GTEST_SKIP() << "there is no Xvfb: `apt-get install xvfb`";
    const Desktop desktop(320, 240, {"-extension", "GLX"});
    const TemporaryFolder folder;
    ChildProgram viewer({VIEWER}, folder.file("viewer.txt"), {"DISPLAY=" + desktop.display()});
    EXPECT_EQ(viewer.wait(), 1);
    const std::string text = content_of(folder.file("viewer.txt"));
    for (const char* word : {"no window can be opened", "GLX", "Remedy", "driver"})
        EXPECT_NE(text.find(word), std::string::npos) << text;
}

TEST(ViewerWithoutDisplay, EndsWithARemedy) {
    const TemporaryFolder folder;
    ChildProgram viewer({"env", "-u", "DISPLAY", "-u", "WAYLAND_DISPLAY", VIEWER},
                        folder.file("viewer.txt"));
    EXPECT_EQ(viewer.wait(), 1);
    const std::string text = content_of(folder.file("viewer.txt"));
    for (const char* word : {"no window can be opened", "DISPLAY", "Remedy", "xvfb-run"})
        EXPECT_NE(text.find(word), std::string::npos) << text;
}

}  // namespace cloth::viewer_window_test
