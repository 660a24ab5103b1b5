//! Checks of the robot as a whole: names, parents, one root, no cycles; and the order of its parts.

use super::checked::{CheckedLink, CheckedRobot, LinkReference, Order, Surface};
use super::foreign;
use super::scope::{Scope, Version};
use super::xml::{Document, Node, is_unprintable};
use super::{joint, link};
use crate::diagnostic::words::did_you_mean;
use std::collections::HashMap;
use std::ops::Range;
use std::path::Path;

/// Top-level tags of other programs.
const FOREIGN: [&str; 6] = [
    "deformable",
    "group",
    "link_state_publisher",
    "model",
    "sensor",
    "velocity",
];

/// Checks everything that does not need files. `None` if there is no robot to go on with.
pub(super) fn check<'d>(
    scope: &mut Scope,
    document: &'d Document<'d>,
    file: &str,
) -> Option<CheckedRobot<'d>> {
    let root = document.root();
    refuse_xacro(scope, root, file)?;
    if root.name() != "robot" {
        let message = format!("the root element is <{}>, not <robot>", root.name());
        let help = match root.name() {
            "sdf" => "this is an SDF file: convert it to URDF first",
            "mujoco" => "this is an MJCF file: convert it to URDF first",
            "xacro" => "expand the file with the xacro command first",
            _ => "a URDF starts with <robot name=\"…\">",
        };
        scope.report.error("U007", root.name_at(), message, help);
        return None;
    }
    "robot".clone_into(&mut scope.owner);
    scope.known_attributes(root, &["name", "version"]);
    let known: Vec<&str> = ["link", "joint", "material"]
        .into_iter()
        .chain(foreign::TOP_LEVEL)
        .chain(scope.sensors.then_some("sensor"))
        .collect();
    scope.known_children(root, &known, &FOREIGN);
    scope.version = version(scope, root);
    let name = robot_name(scope, root, file);
    let links = named(scope, root, "link");
    let joints = named(scope, root, "joint");
    if links.is_empty() && root.child("link").is_none() {
        let help = if root.child("disable_collisions").is_some() || root.child("group").is_some() {
            "this is an SRDF file, which says which links may touch each other: give the URDF"
        } else {
            "a robot has at least one <link name=\"…\"/> directly in <robot>"
        };
        scope
            .report
            .error("U010", root.tag_at(), "the robot has no links", help);
        return None;
    }
    let mut robot = CheckedRobot {
        name,
        closures: Vec::new(),
        named: links.len() == root.children_named("link").count()
            && joints.len() == root.children_named("joint").count(),
        links: links
            .iter()
            .map(|&(node, name)| link::check(scope, node, name))
            .collect(),
        joints: joints
            .iter()
            .map(|&(node, name)| joint::check(scope, node, name))
            .collect(),
    };
    declare_world(scope, &mut robot);
    joint::check_mimics(scope, &robot.joints);
    foreign::read(scope, root, &mut robot);
    Some(robot)
}

/// Adds the link `world` where joints hang on it and the file does not declare it: Drake knows it
/// by itself, and files written for Drake count on that.
fn declare_world(scope: &mut Scope, robot: &mut CheckedRobot) {
    const WORLD: &str = "world";
    if robot.links.iter().any(|link| link.name == WORLD) {
        return;
    }
    let on_world = |reference: &Option<LinkReference>| {
        let reference = reference.as_ref().filter(|parent| parent.name == WORLD);
        reference.map(|parent| parent.at.clone())
    };
    let first = robot.joints.iter().find_map(|joint| {
        let at = on_world(&joint.parent)?;
        Some((joint.node, joint.line, joint.name, at))
    });
    let Some((node, line, name, at)) = first else {
        return;
    };
    scope.owner = format!("joint '{name}'");
    let message = "parent link 'world' does not exist: it is taken as the world itself";
    scope.warning("U016", at, message, "write <link name=\"world\"/>");
    robot.links.push(CheckedLink {
        node,
        line,
        name: WORLD,
        inertial: None,
        collisions: Vec::new(),
        visuals: Vec::new(),
        surface: Surface::default(),
    });
}

/// A file with xacro code in it is not yet a URDF.
fn refuse_xacro(scope: &mut Scope, root: Node, file: &str) -> Option<()> {
    /// Tags that can be expanded by themselves.
    const DEFINES: [&str; 6] = ["include", "macro", "property", "arg", "if", "unless"];
    // The prefix is xacro by custom; the root may bind another.
    let mut prefixes = vec!["xacro"];
    for (name, _) in root.attribute_names() {
        let prefix = name.strip_prefix("xmlns:").filter(|&p| p != "xacro");
        let is_xacro = || root.value(name).is_some_and(|uri| uri.contains("/xacro"));
        if let Some(prefix) = prefix
            && is_xacro()
        {
            prefixes.push(prefix);
        }
    }
    let prefixed = |node: &Node| {
        let prefix = node.name().split_once(':').map(|(prefix, _)| prefix);
        prefix.is_some_and(|prefix| prefixes.contains(&prefix))
    };
    let Some(code) = root.descendants().find(prefixed) else {
        return Some(());
    };
    // What other programs do with a call whose macro is nowhere: nobody can expand it.
    let local = |node: &Node| {
        node.name()
            .rsplit(':')
            .next()
            .unwrap_or_default()
            .to_owned()
    };
    let defines = |node: Node| DEFINES.contains(&local(&node).as_str());
    if !root.descendants().filter(prefixed).any(defines) && root.child("link").is_some() {
        let message = format!(
            "<{}> calls a macro that the file does not have: it is left out",
            code.name()
        );
        let help = "give the .xacro file that this file was made of, if the robot lacks something";
        scope.report.warning("U006", code.tag_at(), message, help);
        return Some(());
    }
    // a.urdf.xacro and a.xacro become a.urdf, a.urdf becomes a.expanded.urdf.
    let stem = file.strip_suffix(".xacro").unwrap_or(file);
    let is_urdf = Path::new(stem).extension().is_some_and(|e| e == "urdf");
    let output = match (is_urdf, stem == file) {
        (true, false) => stem.to_owned(),
        (true, true) => Path::new(stem)
            .with_extension("expanded.urdf")
            .display()
            .to_string(),
        (false, _) => format!("{stem}.urdf"),
    };
    let message = format!(
        "<{}> is xacro code: the file is not yet a URDF",
        code.name()
    );
    let help = format!(
        "expand it first: xacro {} -o {}\n(the command xacro comes with ROS, or with: pip install xacro)",
        quoted(file),
        quoted(&output)
    );
    scope.report.error("U006", code.tag_at(), message, help);
    None
}

/// For a shell: in quotes where it must be.
fn quoted(path: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "_-./\\:".contains(c);
    if path.chars().all(plain) {
        path.to_owned()
    } else {
        format!("'{}'", path.replace('\'', "'\\''"))
    }
}

fn version(scope: &mut Scope, root: Node) -> Version {
    let Some(attribute) = root.attribute("version") else {
        return Version(1, 0);
    };
    let parsed = attribute
        .value
        .trim()
        .split_once('.')
        .and_then(|(major, minor)| Some(Version(major.parse().ok()?, minor.parse().ok()?)));
    parsed.unwrap_or_else(|| {
        let message = format!("'{}' is no URDF version; read as 1.0", attribute.value);
        let help = "write version=\"1.0\", or leave it out";
        scope.warning("U019", attribute.at.clone(), &message, help);
        Version(1, 0)
    })
}

fn robot_name(scope: &mut Scope, root: Node, file: &str) -> String {
    if let Some(name) = root
        .value("name")
        .map(str::trim)
        .filter(|name| !name.is_empty())
    {
        return name.replace(is_unprintable, " ");
    }
    let stem = file.rsplit(['/', '\\']).next().unwrap_or(file);
    let stem = stem
        .split('.')
        .next()
        .filter(|s| !s.is_empty())
        .unwrap_or("robot");
    let message = format!("the robot has no name: '{stem}' is used");
    scope
        .report
        .warning("U015", root.tag_at(), message, "write <robot name=\"…\">");
    stem.to_owned()
}

/// The elements `<tag>` below the root with their names; those without a name, or with one that is
/// taken, are reported.
fn named<'d>(scope: &mut Scope, root: Node<'d>, tag: &'static str) -> Vec<(Node<'d>, &'d str)> {
    let mut list = Vec::new();
    let mut first: HashMap<&str, Range<usize>> = HashMap::new();
    for node in root.children_named(tag) {
        let Some(attribute) = node.attribute("name") else {
            let message = format!("<{tag}> has no name");
            let help = "write name=\"…\"";
            scope.report.error("U015", node.tag_at(), message, help);
            continue;
        };
        let name = attribute.value.as_str();
        if name.trim().is_empty() {
            let message = format!("<{tag}> has an empty name");
            scope
                .report
                .error("U015", attribute.at.clone(), message, "give it a name");
            continue;
        }
        if name.contains(is_unprintable) {
            let message = format!("the name of a <{tag}> contains a control character");
            let help = "use letters, digits and _";
            scope
                .report
                .error("U015", attribute.at.clone(), message, help);
            continue;
        }
        if let Some(earlier) = first.get(name) {
            let line = scope.report.line(earlier.start);
            let message = format!("a second {tag} is named '{name}'");
            let help = format!("the first is in line {line}; names must differ");
            scope
                .report
                .error("U014", attribute.at.clone(), message, help);
            continue;
        }
        first.insert(name, attribute.at.clone());
        list.push((node, name));
    }
    list
}

/// Checks that the links hang together as one tree, and orders them.
pub(super) fn order(scope: &mut Scope, robot: &CheckedRobot) -> Option<Order> {
    if !robot.named {
        return None;
    }
    let links: HashMap<&str, usize> = robot
        .links
        .iter()
        .enumerate()
        .map(|(i, link)| (link.name, i))
        .collect();
    let mut complete = true;
    // Per link: the joint above it, and the joints below it in file order.
    let mut above: Vec<Option<usize>> = vec![None; robot.links.len()];
    let mut below: Vec<Vec<usize>> = vec![Vec::new(); robot.links.len()];
    let mut children = vec![usize::MAX; robot.joints.len()];
    for (j, joint) in robot.joints.iter().enumerate() {
        scope.owner = format!("joint '{}'", joint.name);
        let mut index = |reference: &Option<LinkReference>, what: &str| -> Option<usize> {
            let reference = reference.as_ref()?;
            let found = links.get(reference.name).copied();
            if found.is_none() {
                let message = format!("{what} link '{}' does not exist", reference.name);
                let help = did_you_mean(reference.name, robot.links.iter().map(|l| l.name));
                scope.problem("U016", reference.at.clone(), &message, help);
            }
            found
        };
        let parent = index(&joint.parent, "parent");
        let child = index(&joint.child, "child");
        let (Some(parent), Some(child), Some(reference)) = (parent, child, &joint.child) else {
            complete = false;
            continue;
        };
        if let Some(other) = above[child] {
            let message = format!("link '{}' has two parents", reference.name);
            let help = format!(
                "joint '{}' holds it too: a URDF is a tree, close loops outside of it",
                robot.joints[other].name
            );
            scope.problem("U013", reference.at.clone(), &message, help);
            complete = false;
            continue;
        }
        above[child] = Some(j);
        below[parent].push(j);
        children[j] = child;
    }
    if !complete {
        return None;
    }
    let roots: Vec<usize> = (0..robot.links.len())
        .filter(|&i| above[i].is_none())
        .collect();
    if let [first, second, ..] = roots[..] {
        let node = robot.links[second].node;
        let at = node
            .attribute("name")
            .map_or_else(|| node.tag_at(), |a| a.at.clone());
        let names: Vec<&str> = roots
            .iter()
            .take(10)
            .map(|&i| robot.links[i].name)
            .collect();
        let message = format!(
            "the robot has {} root links: {}",
            roots.len(),
            names.join(", ")
        );
        let help = format!(
            "only one link may be no joint's child; join '{}' to '{}' or remove it",
            robot.links[second].name, robot.links[first].name
        );
        scope.report.error("U011", at, message, help);
    }
    let mut order = Order {
        links: Vec::with_capacity(robot.links.len()),
        joints: Vec::with_capacity(robot.joints.len()),
    };
    let mut reached = vec![false; robot.links.len()];
    for &root in &roots {
        // Depth first, so that a chain stays together; file order among siblings.
        let mut open: Vec<usize> = Vec::new();
        let mut visit = |link: usize, open: &mut Vec<usize>, order: &mut Order| {
            reached[link] = true;
            order.links.push(link);
            open.extend(below[link].iter().rev());
        };
        visit(root, &mut open, &mut order);
        while let Some(j) = open.pop() {
            order.joints.push(j);
            visit(children[j], &mut open, &mut order);
        }
    }
    if let Some(lost) = reached.iter().position(|&r| !r) {
        report_cycle(scope, robot, lost, &above, &links);
        return None;
    }
    (roots.len() == 1).then_some(order)
}

/// Follows the parents of a link that hangs on no root until they repeat.
fn report_cycle(
    scope: &mut Scope,
    robot: &CheckedRobot,
    start: usize,
    above: &[Option<usize>],
    links: &HashMap<&str, usize>,
) {
    let parent = |link: usize| -> Option<(usize, usize)> {
        let j = above[link]?;
        let name = robot.joints[j].parent.as_ref()?.name;
        Some((j, *links.get(name)?))
    };
    let mut seen = vec![false; robot.links.len()];
    let mut link = start;
    while !std::mem::replace(&mut seen[link], true) {
        match parent(link) {
            Some((_, up)) => link = up,
            None => return,
        }
    }
    // `link` is on the cycle; go round once to name its joints, the highest first.
    let mut joints = Vec::new();
    let mut next = link;
    while let Some((j, up)) = parent(next) {
        joints.push(j);
        next = up;
        if next == link {
            break;
        }
    }
    joints.reverse();
    let Some(&last) = joints.iter().max() else {
        return;
    };
    let names: Vec<&str> = joints
        .iter()
        .take(10)
        .map(|&j| robot.joints[j].name)
        .collect();
    let joint = &robot.joints[last];
    let at = joint
        .child
        .as_ref()
        .map_or_else(|| joint.node.tag_at(), |c| c.at.clone());
    let message = format!("the joints {} form a cycle", names.join(", "));
    let help =
        "a URDF is a tree with one root: remove one of them, or turn its parent and child round";
    scope.report.error("U012", at, message, help);
}
