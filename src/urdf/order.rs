//! Order of a robot's links and joints: parents, one root, no cycles.
//!
//! A fault here hides no other one: where links and joints make no tree, they are put together as
//! one all the same, so that what else is wrong with them is told in the same run.

use super::checked::{CheckedJoint, CheckedLink, CheckedRobot, LinkReference, Order, Surface};
use super::options::MissingMass;
use super::scope::Scope;
use crate::diagnostic::words::did_you_mean;
use crate::model::JointKind;
use crate::spatial::Vec3;
use std::collections::{HashMap, HashSet};
use std::ops::Range;

/// The link that each joint holds, and the joint above and those below each link.
struct Tree {
    /// By joint.
    children: Vec<Option<usize>>,
    /// By link.
    above: Vec<Option<usize>>,
    /// By link, in file order.
    below: Vec<Vec<usize>>,
}

/// Links by their own names.
fn index<'d>(links: &[CheckedLink<'d>]) -> HashMap<&'d str, usize> {
    let own = links.iter().enumerate().filter(|(_, link)| link.own_name);
    own.map(|(i, link)| (link.name, i)).collect()
}

/// Checks that the links hang together as one tree, and orders them; none after an error was
/// reported.
///
/// A joint that names a link which is nowhere hides no other fault: all that can be told without it
/// is told.
pub(super) fn order(scope: &mut Scope, robot: &CheckedRobot) -> Option<Order> {
    let links = index(&robot.links);
    let nameless = robot.links.iter().filter(|link| link.name.is_empty());
    let nameless = nameless.count();
    let ends = robot.joints.iter().flat_map(|j| [&j.parent, &j.child]);
    let unknown: HashSet<&str> = ends
        .flatten()
        .map(|end| end.name)
        .filter(|name| !links.contains_key(name))
        .collect();
    let held: HashSet<&str> = robot
        .joints
        .iter()
        .filter_map(|j| Some(j.child.as_ref()?.name))
        .collect();
    let rootless = robot.links.iter().all(|link| held.contains(link.name));
    // Those that no joint holds, once all are written that one does.
    let tops = unknown.iter().filter(|name| !held.contains(*name)).count();
    // As many may be meant for those that have no name.
    let told = unknown.len() > nameless;
    let mut complete = robot.links.iter().all(|link| link.own_name)
        && robot.joints.iter().all(|joint| joint.own_name);
    // Joints that may hold a link that no other one holds.
    let mut loose = 0;
    let mut tree = Tree {
        children: vec![None; robot.joints.len()],
        above: vec![None; robot.links.len()],
        below: vec![Vec::new(); robot.links.len()],
    };
    for (j, joint) in robot.joints.iter().enumerate() {
        scope.owner = joint.called();
        let mut index = |reference: &Option<LinkReference>, what: &str| -> Option<usize> {
            let reference = reference.as_ref()?;
            let found = links.get(reference.name).copied();
            if found.is_none() {
                let message = format!("{what} link '{}' does not exist", reference.name);
                let is_root = !held.contains(reference.name);
                let others = (is_root, tops, rootless);
                let help = instead(scope, robot, joint, reference.name, others);
                if told {
                    scope.problem("U016", reference.at.clone(), &message, help);
                } else {
                    let message = format!("{message}, unless a link without a name is meant");
                    scope.warning("U068", reference.at.clone(), &message, help);
                }
            }
            found
        };
        let parent = index(&joint.parent, "parent");
        let child = index(&joint.child, "child");
        complete &= parent.is_some();
        let (Some(child), Some(reference)) = (child, &joint.child) else {
            complete = false;
            loose += 1;
            continue;
        };
        if let Some(other) = tree.above[child] {
            let message = format!("link '{}' has two parents", reference.name);
            let help = format!(
                "{} holds it too: a URDF is a tree; remove one of the two, or close the loop by a \
                 [[loop]] of the settings",
                robot.joints[other].called()
            );
            scope.problem("U013", reference.at.clone(), &message, help);
            complete = false;
            continue;
        }
        tree.above[child] = Some(j);
        tree.children[j] = Some(child);
        if let Some(parent) = parent {
            tree.below[parent].push(j);
        }
    }
    let roots: Vec<usize> = (0..robot.links.len())
        .filter(|&i| tree.above[i].is_none() && robot.links[i].own_name)
        .collect();
    if roots.len() > 1 + loose {
        report_roots(scope, robot, &roots, loose);
    } else if roots.len() > 1 && !told && nameless > 0 {
        let root = &robot.links[roots[1]];
        scope.owner = format!("link '{}'", root.name);
        let message = "no joint holds it, unless one is meant whose child is not known";
        let help = "only one link may be no joint's child";
        scope.warning("U068", root.node.tag_at(), message, help);
    }
    let (order, reached) = tree.walk(&roots);
    let lost = (0..reached.len()).filter(|&link| !reached[link] && robot.links[link].own_name);
    let mut walks = vec![None; robot.links.len()];
    for start in lost {
        complete = false;
        if report_cycle(scope, robot, start, &tree.above, &links, &mut walks) {
            break;
        }
    }
    (complete && roots.len() == 1).then_some(order)
}

/// What else helps where a joint moves a link that is to be written.
const OF_MASS: &str = "; what a joint moves needs mass: give the link an <inertial>, or pass \
                       --missing-mass 0.1 for 0.1 kg";

/// What else helps with a link that is to be written: it has no mass, which would be told next.
fn of_mass(scope: &Scope, robot: &CheckedRobot, joint: &CheckedJoint, name: &str) -> &'static str {
    let holds = |other: &CheckedJoint| other.parent.as_ref().is_some_and(|p| p.name == name);
    let still = joint.kind == JointKind::Fixed || robot.joints.iter().any(holds);
    if still || scope.missing_mass == MissingMass::All {
        return "";
    }
    OF_MASS
}

/// What to do about a link that does not exist and that a joint names.
///
/// - `others`: as [`declared`] takes them
fn instead(
    scope: &Scope,
    robot: &CheckedRobot,
    joint: &CheckedJoint,
    name: &str,
    (is_root, tops, rootless): (bool, usize, bool),
) -> String {
    let ends = [&joint.parent, &joint.child];
    let own = ends.map(|end| end.as_ref().map(|end| end.name));
    let known = robot.links.iter().filter(|link| link.own_name);
    let known = known.map(|link| link.name);
    // Not the link on the joint's other side.
    let known = known.filter(|known| !own.contains(&Some(known)));
    // Nor another one of a row: 'link0' is not what is meant by 'link8'.
    let (row, others): (Vec<_>, Vec<_>) = known.partition(|known| of_one_row(known, name));
    let mut help = did_you_mean(name, others);
    if !help.is_empty() {
        return help;
    }
    help = declared(name, is_root, tops, rootless);
    if let ("", [first, ..]) = (&*help, &row[..]) {
        help = format!(
            "give the file of the whole robot if this is a part of it, or write the name that is \
             meant: '{first}' is another one of its row"
        );
    }
    if !is_root {
        help.push_str(of_mass(scope, robot, joint, name));
    }
    help
}

/// Whether two names differ in numbers alone.
fn of_one_row(a: &str, b: &str) -> bool {
    let digit = |c: char| c.is_ascii_digit();
    let letters = |name: &str| name.replace(digit, "");
    let numbers = |name: &str| -> Vec<String> {
        let words = name.split(|c| !digit(c)).filter(|word| !word.is_empty());
        words
            .map(|word| word.trim_start_matches('0').to_owned())
            .collect()
    };
    let (first, second) = (numbers(a), numbers(b));
    letters(a) == letters(b) && first.len() == second.len() && first != second
}

/// Advice on a link that does not exist, where none has a name that is near.
///
/// - `is_root`: whether no joint has it as its child
/// - `tops`: how many links do not exist of which that is so
/// - `rootless`: whether each link that exists is some joint's child
fn declared(name: &str, is_root: bool, tops: usize, rootless: bool) -> String {
    match tops {
        _ if !is_root => format!("write <link name=\"{name}\"/>, or correct the name"),
        1 if rootless => format!(
            "write <link name=\"{name}\"/> for a root, or give the file of the whole robot if this \
             is a part of it"
        ),
        _ if rootless => {
            "give the file of the whole robot if this is a part of it, or correct the names"
                .to_owned()
        }
        _ => String::new(),
    }
}

impl Tree {
    /// The order from some roots down, and which links are reached.
    fn walk(&self, roots: &[usize]) -> (Order, Vec<bool>) {
        let mut order = Order {
            links: Vec::with_capacity(self.above.len()),
            joints: Vec::with_capacity(self.children.len()),
        };
        let mut reached = vec![false; self.above.len()];
        for &root in roots {
            // Depth first, so that a chain stays together; file order among siblings.
            let mut next = Some((root, None));
            let mut open: Vec<usize> = Vec::new();
            while let Some((link, joint)) = next {
                order.joints.extend(joint);
                order.links.push(link);
                reached[link] = true;
                open.extend(self.below[link].iter().rev());
                next = std::iter::from_fn(|| open.pop()).find_map(|j| {
                    let child = self.children[j]?;
                    Some((child, Some(j)))
                });
            }
        }
        (order, reached)
    }
}

/// As many names as [`mend`] may need for a robot of so many elements.
pub(super) fn spare_names(elements: usize) -> Vec<String> {
    // Each link may need a name and a joint, each joint a name and a link; and the file may have as
    // many of these names as there are links, joints and their ends.
    (0..5 * elements).map(|k| format!("unnamed {k}")).collect()
}

/// Makes a tree of links and joints that are none, and orders it: who has no name gets one, a joint
/// that holds no link of its own gets an empty one, and roots hang on the first.
///
/// - `spare`: names
pub(super) fn mend<'d>(robot: &mut CheckedRobot<'d>, spare: &'d [String]) -> Order {
    let ends = robot.joints.iter().flat_map(|j| [&j.parent, &j.child]);
    let mut taken: HashSet<&str> = ends.flatten().map(|end| end.name).collect();
    taken.extend(robot.links.iter().map(|link| link.name));
    taken.extend(robot.joints.iter().map(|joint| joint.name));
    let mut spare = spare.iter().map(String::as_str);
    let mut name = || spare.find(|name| !taken.contains(name)).unwrap_or_default();
    for link in robot.links.iter_mut().filter(|link| !link.own_name) {
        (link.name, link.own_name) = (name(), true);
    }
    for joint in robot.joints.iter_mut().filter(|joint| !joint.own_name) {
        (joint.name, joint.own_name) = (name(), true);
    }
    let mut links = index(&robot.links);
    // Who can be reached from whom: a link's topmost one, as far as is known.
    let mut tops: Vec<usize> = (0..robot.links.len()).collect();
    let mut held = vec![false; robot.links.len()];
    let first = robot.joints.iter().filter_map(|joint| {
        let child = links.get(joint.child.as_ref()?.name)?;
        Some(*child)
    });
    let children: HashSet<usize> = first.collect();
    let root = (0..robot.links.len()).find(|i| !children.contains(i));
    let root = root.unwrap_or_default();
    held[root] = true;
    for joint in &mut robot.joints {
        let at = joint.node.tag_at();
        let parent = joint.parent.as_ref().and_then(|p| links.get(p.name));
        let parent = parent.copied().unwrap_or(root);
        let child = joint
            .child
            .as_ref()
            .and_then(|c| links.get(c.name))
            .copied();
        let free = child.filter(|&child| !held[child] && top(&mut tops, parent) != child);
        let child = free.unwrap_or_else(|| {
            let unknown = joint.child.as_ref().filter(|_| child.is_none());
            let name = unknown.map_or_else(&mut name, |child| child.name);
            let made = robot.links.len();
            robot.links.push(made_up(joint, name));
            links.insert(name, made);
            tops.push(made);
            held.push(false);
            made
        });
        held[child] = true;
        tops[child] = top(&mut tops, parent);
        joint.parent = Some(end(&robot.links[parent], &at));
        joint.child = Some(end(&robot.links[child], &at));
    }
    for i in (0..robot.links.len()).filter(|&i| !held[i]) {
        let at = robot.links[i].node.tag_at();
        let (parent, child) = (end(&robot.links[root], &at), end(&robot.links[i], &at));
        robot.joints.push(CheckedJoint {
            node: robot.links[i].node,
            tag: robot.links[i].tag.clone(),
            name: name(),
            own_name: true,
            kind: JointKind::Fixed,
            parent: Some(parent),
            child: Some(child),
            xyz: Vec3::zeros(),
            rpy: Vec3::zeros(),
            axis: Vec3::x(),
            limits: None,
            effort: None,
            velocity: None,
            damping: 0.0,
            friction: 0.0,
            armature: 0.0,
            interfaces: Vec::new(),
            mimic: None,
        });
    }
    let of = |end: &Option<LinkReference>| links.get(end.as_ref()?.name).copied();
    let mut tree = Tree {
        children: robot.joints.iter().map(|joint| of(&joint.child)).collect(),
        above: vec![None; robot.links.len()],
        below: vec![Vec::new(); robot.links.len()],
    };
    for (j, joint) in robot.joints.iter().enumerate() {
        if let Some(parent) = of(&joint.parent) {
            tree.below[parent].push(j);
        }
    }
    tree.walk(&[root]).0
}

/// A joint's end at a link.
fn end<'d>(link: &CheckedLink<'d>, at: &Range<usize>) -> LinkReference<'d> {
    LinkReference {
        name: link.name,
        at: at.clone(),
    }
}

/// The topmost link above one.
fn top(tops: &mut [usize], link: usize) -> usize {
    let mut top = link;
    while tops[top] != top {
        top = tops[top];
    }
    // The way is shorter next time.
    let mut next = link;
    while tops[next] != top {
        next = std::mem::replace(&mut tops[next], top);
    }
    top
}

/// A link that only a joint names.
fn made_up<'d>(joint: &CheckedJoint<'d>, name: &'d str) -> CheckedLink<'d> {
    CheckedLink {
        node: joint.node,
        tag: joint.tag.clone(),
        name,
        own_name: false,
        inertial: None,
        collisions: Vec::new(),
        visuals: Vec::new(),
        surface: Surface::default(),
    }
}

/// - `loose`: how many of the roots may be children of joints that are told already
fn report_roots(scope: &mut Scope, robot: &CheckedRobot, roots: &[usize], loose: usize) {
    let [first, second, ..] = *roots else { return };
    let node = robot.links[second].node;
    let at = node
        .attribute("name")
        .map_or_else(|| node.tag_at(), |a| a.at.clone());
    let names = roots.iter().take(10).map(|&i| robot.links[i].name);
    let names = names.collect::<Vec<_>>().join(", ");
    let count = roots.len();
    let (message, help) = if loose == 0 {
        let (first, second) = (robot.links[first].name, robot.links[second].name);
        (
            format!("the robot has {count} root links: {names}"),
            format!(
                "only one link may be no joint's child; join '{second}' to '{first}' or remove it"
            ),
        )
    } else {
        let joints = if loose == 1 { "joint" } else { "joints" };
        (
            format!(
                "the robot has {count} root links, more than the {loose} {joints} without a child explain: {names}"
            ),
            "only one link may be no joint's child; join the others or remove them".to_owned(),
        )
    };
    scope.report.error("U011", at, message, help);
}

/// Follows the parents of a link that hangs on no root until they repeat; whether they do.
///
/// - `walks`: by link, from where it was come by
fn report_cycle(
    scope: &mut Scope,
    robot: &CheckedRobot,
    start: usize,
    above: &[Option<usize>],
    links: &HashMap<&str, usize>,
    walks: &mut [Option<usize>],
) -> bool {
    let parent = |link: usize| -> Option<(usize, usize)> {
        let j = above[link]?;
        let name = robot.joints[j].parent.as_ref()?.name;
        Some((j, *links.get(name)?))
    };
    let mut link = start;
    while walks[link].is_none() {
        walks[link] = Some(start);
        match parent(link) {
            Some((_, up)) => link = up,
            None => return false,
        }
    }
    if walks[link] != Some(start) {
        return false;
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
        return false;
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
    let (message, help) = match names[..] {
        [name] => (
            format!(
                "joint '{name}' joins link '{}' to itself",
                robot.links[link].name
            ),
            "name another link as its parent or as its child",
        ),
        _ => (
            format!("the joints {} form a cycle", names.join(", ")),
            "a URDF is a tree with one root: remove one of them, or turn its parent and child round",
        ),
    };
    scope.report.error("U012", at, message, help);
    true
}
