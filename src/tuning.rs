//! Every number of the method: unit, reason, and the test that fails without it, where there is
//! one. A test that is named with a value (`At 0 fails …`) has been seen to fail with it.
//!
//! Over 500 lines because it is one list of numbers, each with its reason.
//!
//! This is the lowest layer: it uses no other module. Physical defaults that a user may set
//! (friction coefficients, penetration, gains) are in [`crate::settings`]; ranges of what a user
//! may set are in [`crate::range`]. [`Rules`] switches whole rules off, for tests and for measuring
//! what each rule does.

/// Rules of the method, each of which a test can switch off. All are on in an FMU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "each is switched by itself")]
pub struct Rules {
    /// A robot that stands still while its forces balance stays where it is, without steps. Without
    /// it fails `what_rests_is_carried_without_steps_and_wakes`.
    pub rest: bool,
    /// What moves freely keeps its momentum: free joints take up what steps have lost or made.
    /// Without it fails `what_moves_freely_keeps_its_momentum_wherever_its_joints_hang`.
    pub momentum: bool,
    /// A body on which nothing acts goes on by Euler's equations alone. Without it fails
    /// `what_whirls_beside_others_keeps_its_energy`.
    pub coast: bool,
    /// Explicit Runge–Kutta steps where nothing stiff acts. Without it fails
    /// `an_effort_that_varies_in_time_is_integrated_within_one_step`.
    pub explicit: bool,
    /// Smooth steps reach beyond the communication point while no input changes. Without it fails
    /// `communication_points_do_not_change_a_smooth_motion`.
    pub look_ahead: bool,
    /// Friction cones follow the normal forces that a solve finds, and its direction foresees them.
    /// Without it fails `d5_axles_that_work_against_each_other_agree_with_short_steps`.
    pub cones: bool,
    /// Steps end where a point touches down or a joint reaches its limit. Without it fails
    /// `bodies_without_losses_make_no_energy_whatever_they_meet_with`.
    pub touchdown: bool,
    /// A bounce is taken in parts of its own duration. Without it fails
    /// `c8_a_ball_rebounds_with_the_coefficient_of_restitution_at_every_speed`.
    pub bounce: bool,
    /// A run of steps near the shortest length raises that length. Without it fails
    /// `a_spring_that_swings_too_fast_to_be_seen_comes_to_its_target`.
    pub floor: bool,
    /// A step that makes too much energy is taken otherwise. Without it fails
    /// `a_rotor_runs_up_along_its_torque_speed_line`.
    pub energy: bool,
    /// A step that makes some energy is solved again with contacts that agree with their depths at
    /// its ends. Without it fails `d8_a_passive_robot_never_gains_energy`.
    pub secants: bool,
    /// A step that fails ends with its first stage, where that alone is good. Without it fails
    /// `a_limb_that_comes_to_its_limit_takes_few_steps`.
    pub first_stage: bool,
    /// Fixed steps are taken in parts where something turns far in one. Without it fails
    /// `fixed_steps_are_split_for_fast_limbs_but_not_for_wheels`.
    pub parts: bool,
    /// Trees that cannot meet within a communication step have steps of their own. Without it fails
    /// `each_island_has_steps_of_its_own`.
    pub islands: bool,
}

impl Rules {
    /// Every rule acts.
    pub const ALL: Self = Self {
        rest: true,
        momentum: true,
        coast: true,
        explicit: true,
        look_ahead: true,
        cones: true,
        touchdown: true,
        bounce: true,
        floor: true,
        energy: true,
        secants: true,
        first_stage: true,
        parts: true,
        islands: true,
    };
}

impl Default for Rules {
    fn default() -> Self {
        Self::ALL
    }
}

// Error control: `step/driver.rs`, `step/size.rs`.

/// Tolerance where neither the model nor the importer gives one: a step errs by a centimetre a
/// second at arm's length (`the_tolerance_is_the_models_else_the_importers_else_a_thousandth`).
pub const DEFAULT_TOLERANCE: f64 = 1e-3;
/// Least and greatest tolerance that the error control works with: below, round-off decides; above,
/// an error of the size of the robot would pass. At 1e-3 as the least fails
/// `fixed_steps_agree_with_error_control_where_corners_slip_briefly`.
pub const TOLERANCES: (f64, f64) = (1e-12, 1.0);
/// First guess of the step after initialisation, s; the error control corrects it within a few
/// steps. At 0.05 fails `the_communication_step_does_not_change_the_result_beyond_the_tolerance`.
pub const INITIAL_STEP: f64 = 1e-3;
/// Longest step, s: a robot at rest in the air must still notice that it falls, and what tumbles
/// may not turn so far in a step that the estimate of its error means nothing. At 1e-3 fails
/// `damping_of_any_strength_is_followed_in_few_steps`, at 0.1
/// `b6_a_limit_rebounds_by_its_law_and_carries_a_load_at_its_stiffness`.
pub const MAX_STEP: f64 = 0.05;
/// Shortest step that the error control asks for, s; a step that fails its test there is accepted
/// and counted. At 1e-4 fails `fixed_steps_agree_with_error_control_where_corners_slip_briefly`.
pub const MIN_STEP: f64 = 1e-7;
/// Shrinkage and growth of the step, at most. At 0.9 and 1.001 fails
/// `damping_of_any_strength_is_followed_in_few_steps`.
pub const GROWTH: (f64, f64) = (0.1, 5.0);
/// Share of the step that the error estimate allows which an implicit step takes next. At 3 fails
/// `fixed_steps_agree_with_error_control_where_a_motor_jumps_to_its_speed`.
pub const IMPLICIT_SAFETY: f64 = 0.9;
/// The same for a Runge–Kutta step: at 0.9 every fourth was taken in vain on swinging arms, at 0.8
/// every tenth. At 3 fails `communication_points_do_not_change_a_smooth_motion`.
pub const EXPLICIT_SAFETY: f64 = 0.8;
/// Least error, relative to the tolerance, that the next step is computed from, of implicit and of
/// explicit steps: keeps the division finite, far below what limits the growth. At 10 for both
/// fails `damping_of_any_strength_is_followed_in_few_steps`.
pub const LEAST_ERROR: (f64, f64) = (1e-12, 1e-10);
/// Time by which an error of a velocity, or of the mean velocity of a step, counts as one of a
/// position, s. At 0 fails `bodies_that_meet_in_space_keep_their_momentum`.
pub const VELOCITY_WEIGHT: f64 = 0.1;
/// A step that would leave less than half of its length to the communication point is taken as two
/// equal ones: `1 + 1/2` times its length. At 100 fails
/// `an_effort_that_varies_in_time_is_integrated_within_one_step`.
pub const LANDING: f64 = 1.5;

// Rising floor of the step: `step/size.rs`.

/// Largest value that the shortest step may rise to at a tolerance of 1e-3, s. At 1e-7 fails
/// `a_spring_that_swings_too_fast_to_be_seen_comes_to_its_target`.
pub const MAX_FLOOR: f64 = 1e-4;
/// Tolerance at which the floor rises that far; below, it rises with the root of the tolerance,
/// like the steps that the tolerance asks for. What the shortest step errs by more than this is
/// not resolved. At 1e9 fails `a_spring_that_swings_too_fast_to_be_seen_comes_to_its_target`.
pub const FLOOR_TOLERANCE: f64 = 1e-3;
/// Angle, rad, that something may turn by in the shortest step: one that errs by more than the
/// tolerance and is taken all the same makes energy where something whirls. At 1 fails
/// `what_whirls_makes_no_energy_although_short_steps_have_gone_before`.
pub const FLOOR_TURN: f64 = 0.01;
/// Share by which each step near the floor raises it: an impact passes in some dozens of steps, for
/// which the floor hardly moves. At 0 fails
/// `a_spring_that_swings_too_fast_to_be_seen_comes_to_its_target`.
pub const FLOOR_RISE: f64 = 0.02;
/// Steps shorter than so many times the floor raise it, longer ones lower it. At 0 fails
/// `a_spring_that_swings_too_fast_to_be_seen_comes_to_its_target`.
pub const FLOOR_REACH: f64 = 10.0;
/// Share that a step that goes well leaves of the floor. At 1e9 fails
/// `a_rotor_runs_up_along_its_torque_speed_line`.
pub const FLOOR_FALL: f64 = 0.5;

// Where a step must end: `step/caps.rs`.

/// By how much of the thickness of their contact two shapes may come nearer in a step: what a step
/// expects in its middle must not lie beyond. Without it fails
/// `links_of_one_robot_press_each_other_with_their_motors_force`.
pub const ADVANCE: f64 = 0.5;

/// Product of the distances, in radii, of a load from the middle of a face of a cylinder on either
/// side of it, beyond which a step is not taken in two stages: they would throw the load to and fro
/// across the face. One solve instead is of first order. At 0, where every lean to the other side
/// counts, fails `a_can_on_a_turntable_stays_where_it_stands`.
pub const ACROSS: f64 = 0.1;

/// Longest step of a contact that bounces, as a share of the time √(m/k) of its impact. A slow
/// bounce is shallower than the tolerance, which would not notice that it is missing; but it has
/// its restitution, too. Without it fails
/// `c8_a_ball_rebounds_with_the_coefficient_of_restitution_at_every_speed`.
pub const BOUNCE_SHARE: f64 = 0.1;
/// Longest step with contact, s: a little more than 1/240 s, at which many importers communicate.
/// How a contact is pressed, and what friction holds, is averaged over a step. Without it fails
/// `a_cube_on_a_tilted_table_sticks_below_the_cone_and_slides_above`.
pub const CONTACT_STEP: f64 = 5e-3;
/// Share of a step after which a joint that reaches its limit, or a pd law that reaches its effort
/// limit, ends it: one that is slower in coming there may never. At 1e9 fails
/// `s6_a_saturated_pd_law_ends_where_its_linear_pieces_do`.
pub const CREEP: f64 = 0.1;

// Accuracy of the solves: `step/implicit.rs`, `step/point.rs`, `step/convex`.

/// Accuracy of the impulses of a guess that needs no iteration, relative to the tolerance: what it
/// lacks stays, so that it is the error of a speed that a motor holds. At 0.1 fails
/// `a_loaded_motor_settles_where_its_line_meets_the_load_and_brakes_with_all_its_effort`.
pub const GUESS: f64 = 2e-4;
/// Least and greatest accuracy that this leads to, the latter at a tolerance of 0.0025: what
/// coarser solves leave moves a robot that stands faster than [`REST_SPEED`]. At 1e-3 for both
/// fails `each_island_has_steps_of_its_own`, at 2e-6 for the greatest
/// `robots_come_to_rest_in_steps_of_any_kind_and_accuracy`.
pub const GUESSES: (f64, f64) = (1e-10, 5e-7);
/// Accuracy of impulses after an iteration, relative to that of a guess that needs none: what an
/// iteration leaves is new in each step, and does not add up. At 0 fails
/// `the_contact_forces_of_two_links_are_opposite`, at 1e9
/// `a_sliding_block_stops_after_the_distance_of_its_dynamic_friction`.
pub const ITERATED: f64 = 5000.0;
/// Coarsest accuracy that this leads to, 1e-3: that at the default tolerance. A higher tolerance
/// makes no solve coarser. At 0 fails `the_contact_forces_of_two_links_are_opposite`.
pub const COARSEST: f64 = ITERATED * GUESS * DEFAULT_TOLERANCE;

// Stages: `step/stages.rs`.

/// Share of the second difference of the stages that counts as the error of a step: between 0.1,
/// which is exact for a quadrature, and 2/3, which is exact for a linear force. At 0.02 fails
/// `bodies_that_meet_in_space_keep_their_momentum`.
pub const ESTIMATE: f64 = 0.4;
/// Share of the tolerance that a step may err by because its middle is not where it was expected;
/// where it errs more it is solved again with the middle that it has found. At 1e9 fails
/// `fixed_steps_are_split_for_fast_limbs_but_not_for_wheels`.
pub const MISPLACED: f64 = 0.03;
/// Share of a step in which the forces at its start are found. At 1 fails
/// `the_communication_step_does_not_change_the_result_beyond_the_tolerance`.
pub const START: f64 = 1e-9;

// Rest: `step/driver.rs`.

/// Imbalance of the forces on a robot at rest that does not set it going, relative to the accuracy
/// of a guess that needs no iteration, [`GUESS`] of the tolerance or [`FIXED_ACCURACY`]. It is more
/// than 1: solves leave as much, so that a robot that has nearly come to rest would otherwise be
/// kept in motion for ever. At 0.1 fails `robots_come_to_rest_in_steps_of_any_kind_and_accuracy`,
/// at 1e12 `a_joint_breaks_away_at_its_static_friction_and_turns_with_its_dynamic_one`.
pub const BALANCE: f64 = 1.5;
/// Speed below which a robot may be at rest, rad/s or m/s. At 0 fails
/// `what_rests_is_carried_without_steps_and_wakes`.
pub const REST_SPEED: f64 = 1e-7;

// Friction cones: `step/stages.rs`.

/// Share of the tolerance that a lag of the friction cones may cost, as an error of velocities,
/// before a solve takes other ones. At 0.5 fails
/// `d5_axles_that_work_against_each_other_agree_with_short_steps`.
pub const LAG_SHARE: f64 = 0.02;
/// How often a solve takes its friction cones from its own normal forces, and its direction
/// foresees them, at most, beside the times that halve what they lag behind: then they are
/// constant, so that it converges. At 1 fails
/// `d5_axles_that_work_against_each_other_agree_with_short_steps`.
pub const MAX_CARRIES: usize = 3;

// Explicit steps: `step/explicit.rs`, `step/explicit/tableau.rs`.

/// The short pair takes steps below this share of what the long one proposes, in steps in which
/// both err by the same (`shortened` in `step/explicit.rs`). At 1000 fails
/// `an_effort_that_varies_in_time_is_integrated_within_one_step`.
pub const SHORT: f64 = 0.85;
/// Time constants of the fastest damping that an explicit step may take. Bogacki & Shampine's step
/// is stable up to 2.51 of them; the rest is for the search, which comes to the fastest damping
/// from below. At 20 fails `a_damped_chain_stays_where_it_hangs_in_fixed_steps`.
pub const FADED: f64 = 2.0;
/// Rounds of the search for the fastest motion of laws, springs and dampers. At 0 fails
/// `a_chain_that_pd_laws_hold_is_still_in_steps_of_any_length`.
pub const RATE_ROUNDS: usize = 3;
/// Square of the angle, rad², that a spring of a pd law may turn by in an explicit step: longer
/// steps do not resolve it, and are taken implicitly. At 100 fails
/// `a_spring_that_swings_too_fast_to_be_seen_comes_to_its_target`.
pub const RESOLVED: f64 = 1.0;
/// Share of [`RESOLVED`] that a step takes which is shortened to resolve a spring at any tolerance.
/// At 40 and at 0.004 fails `a_spring_without_damping_swings_on_at_any_tolerance`.
pub const SHARP: f64 = 0.4;
/// Damping ratio of a pd law below which it swings: steps resolve it while they can. At 0 fails
/// `a_spring_without_damping_swings_on_at_any_tolerance`, at 50
/// `a_stiff_spring_with_much_damping_is_not_resolved`.
pub const SWINGING: f64 = 0.5;
/// Error that an explicit step counts as if it has run into something: half the step is tried
/// next. At 0 fails `what_falls_onto_a_limit_presses_it_no_deeper_than_its_energy_can`.
pub const HIT: f64 = 32.0;
/// Share of the tolerance that a Runge–Kutta step may use where nothing damps what it errs by: it
/// adds up, and what is unstable lets it grow, links that tumble about their middle axis by a
/// factor of hundreds in a few seconds. At 1 fails
/// `a_four_bar_stays_closed_and_keeps_its_energy`.
pub const EXPLICIT_SHARE: f64 = 2e-3;
/// The same where damping is implicit: damping forgets; without it twice the steps buy a fiftieth
/// of the error. At 100 fails `b3_a_saturated_rotor_takes_j_omega_over_e`.
pub const DAMPED_SHARE: f64 = 0.1;
/// Least error that is asked of such a step, m or rad at a reach of one metre: below, the round-off
/// of accelerations decides. At 1e-6 fails `andrews_squeezer_is_where_the_test_set_says`.
pub const LEAST_SHARE: f64 = 1e-14;

/// Angle, rad, that a body on which nothing acts may turn by between two places at which Euler's
/// equations are solved, at a tolerance of 1. It goes with the fourth root of the tolerance, so
/// that errors of the fourth order fall with the tolerance. At 4 fails
/// `s5_tumbling_bodies_follow_eulers_equations`.
pub const COASTING_TURN: f64 = 0.4;
/// Most Newton iterations from one of these places to the next: the digits double each time. At 1
/// fails `a_body_alone_keeps_its_energy_and_its_momentum`.
pub const COASTING_ITERATIONS: usize = 5;
/// Square of the change of the angular velocity, relative to it, after which no iteration follows.
/// At 1 fails `a_body_alone_keeps_its_energy_and_its_momentum`.
pub const COASTING_ACCURACY: f64 = 1e-18;
/// How many of these places there may be in a step. They take their time, which no budget of steps
/// notices: without a limit, balls at 10⁶ rad/s take 0.1 s for 1/240 s. No result depends on it
/// that a test sees.
pub const COASTING_MOST: f64 = 2000.0;

// Guards: `step/guards.rs`, `step/flight.rs`.

/// Energy that a fixed step may make out of nothing, as a share of kinetic energy and weight times
/// reach: hundreds of steps together a thousandth. At 0 fails
/// `a_four_bar_stays_closed_in_fixed_steps`.
pub const GAIN: f64 = 1e-5;
/// Energy that a fixed step of one solve may take from what turns in it, as a share of kinetic
/// energy and weight times reach; what takes more is taken in parts. At 1 fails
/// `a_disc_that_wobbles_keeps_its_energy_in_steps_of_any_length`.
pub const DRAINED: f64 = 1e-4;
/// Energy that counts under error control as an error of the size of the tolerance, as a share of
/// the tolerance and of the same energies. At 1e6 fails
/// `a_rotor_runs_up_along_its_torque_speed_line`.
pub const CONTROLLED_GAIN: f64 = 0.05;
/// Energy that a step may make without being solved again with secants, as a share of kinetic
/// energy and weight times reach; at most what it may make at all. It saves solves: at 0 no test
/// fails. At 1, where only what a step may not make is mended, fails
/// `d8_a_passive_robot_never_gains_energy`.
pub const MENDED_GAIN: f64 = 5e-7;
/// By what share of its way a contact's depth has to change otherwise than its rows say, so that a
/// secant takes their place: any step errs by the square of what turns in it. At 0 fails
/// `s8_cans_and_discs_roll_on_their_edges`, at 10 `d8_a_passive_robot_never_gains_energy`.
pub const STEEP: f64 = 0.005;
/// How many times it is, at most: the second time mends what the first has changed. At 0 fails
/// `d8_a_passive_robot_never_gains_energy`; the second one saves steps at the floor.
pub const SECANTS: u32 = 2;
/// How many shares of secants are tried, at most, where all of them take more energy than the step
/// made: each halves what the last ones have left open on a scale of powers. At 0 fails
/// `what_slides_over_an_edge_between_two_boxes_goes_on`.
pub const EASINGS: u32 = 6;

/// `1/(tr I · tr I⁻¹)` of the inertia, 1/9 for a ball and 0 for a rod without thickness, below
/// which a robot in flight keeps its angular velocity as it is: about the axis of a rod it would
/// take up what the step's error of its orientation does to its momentum. At 0 fails
/// `a_thin_rod_in_flight_does_not_spin_up_about_its_axis`.
pub const THIN: f64 = 0.01;

// Fixed steps: `step/fixed.rs`.

/// Error of one solve by itself, relative to the tolerance and to the square of the step, s⁻², up
/// to which the second is left out. That error falls with the step and the limit with its square,
/// so that short steps have both solves. 0.004 at 1/240 s. At 1e15 fails
/// `a_rolling_ball_slows_down_by_its_rolling_friction_and_stands`.
pub const CALM: f64 = 240.0;
/// Relative accuracy of the impulses in fixed steps: of a guess, and after an iteration, there that
/// at the default tolerance. At 1 for both fails
/// `fixed_steps_agree_with_error_control_where_a_motor_jumps_to_its_speed`.
pub const FIXED_ACCURACY: [f64; 2] = [1e-8, COARSEST];
/// Share of a step by which importers' communication steps may be longer than a whole number of
/// fixed steps: they carry round-off. At 0 fails
/// `fixed_steps_are_split_for_fast_limbs_but_not_for_wheels`.
pub const STEP_ROUND_OFF: f64 = 1e-6;
/// Angle, rad, that a limb may turn in a step: one that whirls faster has the step taken in parts.
/// A step takes mass matrix and lever arms as they are at its start, and a radian on they are
/// others: such limbs gained energy without bound. At 100 fails
/// `fixed_steps_are_split_for_fast_limbs_but_not_for_wheels`.
pub const WHIRL: f64 = 0.2;
/// Angle, rad, that a limb may turn in a step of the length that the user fixed whose mass matrix
/// and lever arms are those of its start; where it turns farther they are those of its middle. At 0
/// fails `fixed_steps_agree_with_error_control_where_corners_slip_briefly`.
pub const TURN: f64 = 0.005;
/// Share of the change of velocity with which such a step takes its bias. The middle of its way
/// lies half a change beyond the mean velocity, because positions move with the velocity of the
/// step's end: half of that, and the forces of whirling take as much from one limb as they give to
/// another, up to the third order. At 0.5 and at 1 fails
/// `limbs_that_whirl_keep_their_energy_to_the_second_order_in_fixed_steps`.
pub const AHEAD: f64 = 0.75;
/// Most parts of a step. At 1 fails `fixed_steps_are_split_for_fast_limbs_but_not_for_wheels`.
pub const MAX_PARTS: f64 = 32.0;

// The robot as the solver sees it: `tree.rs`, `tree/scale.rs`.

/// Standard gravity, m/s²: gives the weight that contact stiffness is made from, whatever the
/// tunable gravity is. At 5 fails
/// `the_pairs_of_a_stack_carry_the_weights_above_at_the_depths_of_the_law`.
pub const REFERENCE_GRAVITY: f64 = 9.81;
/// Push of a contact at the start, in weights, above which the start is told as deep. At the depth
/// `contact.penetration` it is 3.6, and who gives a start that depth must not be told by round-off.
/// Eight are at 1.33 such depths: as what falls by 1.7 of them, 0.2 mm, which nobody would be told
/// of. At 3.5555 fails `a_start_as_deep_as_the_penetration_is_not_called_deep_by_round_off`.
pub const DEEP_START: f64 = 8.0;
/// Multiplications per body that the articulated-body algorithm needs beyond the mass matrix' own,
/// measured where both cost the same. At 10 and at 10,000 fails
/// `ropes_are_taken_by_articulated_bodies_and_arms_by_their_mass_matrix`.
pub const ARTICULATED_COST: usize = 150;
/// Unevenness of a wheel, as a share of its inertia, that makes no difference. At 10 fails
/// `fixed_steps_are_split_for_fast_limbs_but_not_for_wheels`.
pub const WHEEL: f64 = 0.02;
/// Position error of a limit under the joint's effort limit, rad or m. At 1e-2 fails
/// `a_servo_pressed_against_a_limit_rests`.
pub const LIMIT_DEFLECTION: f64 = 1e-4;
/// Acceleration, rad/s² or m/s², at which a limit has at least that position error, whatever the
/// effort limit of its joint; see the law of a `Stop`. At 1e9 fails
/// `test_a_double_pendulum_that_strikes_its_limits_is_where_events_say`.
pub const LIMIT_LOAD: f64 = 100.0;
/// Model Exchange alone: nominal value of the displacement of friction, as a share of the
/// penetration, by which it gives way at its cap. What stands or rolls uses a part of it, and
/// importers measure errors by it. At 1 fails
/// `test_r2d2_drives_as_in_co_simulation_at_any_tolerance_near_by`.
pub const SLIP_NOMINAL: f64 = 0.3;
/// Share by which the joint's effort limit drives it beyond its enforced speed limit. At 0.5 fails
/// `an_enforced_velocity_limit_is_exceeded_by_one_percent_under_the_effort_limit`.
pub const OVERSPEED: f64 = 0.01;
/// Longest time that a joint takes to fall back to its enforced speed limit, s. At 1 fails
/// `an_enforced_velocity_limit_is_exceeded_by_one_percent_under_the_effort_limit`.
pub const SPEED_RELAXATION: f64 = 1e-3;

// Islands: `step/islands.rs`.

/// Communication steps for which the velocity at their beginning is taken to last when trees are
/// parted. One lasts a communication step only if nothing is accelerated; with two, trees are
/// seldom parted again. At 0 fails `each_island_has_steps_of_its_own`.
pub const ISLAND_TIME: f64 = 2.0;
/// By what that time grows where a shape has gone farther: few tries lead to one island. At 1e6
/// fails `what_is_far_away_changes_no_bit`.
pub const WIDER: f64 = 4.0;
/// So many times as long, it is not tried again: all trees go together. At 1 fails
/// `what_is_far_away_changes_no_bit`.
pub const WIDEST: f64 = 1e6;

// Contacts: `force/detect.rs`.

/// Gap below which a point takes part in a step whatever its velocity, m. Smaller loses contacts
/// that accelerations close within the step, larger costs time. At 0 fails
/// `a_peg_in_a_hole_comes_to_rest`.
pub const CONTACT_MARGIN: f64 = 1e-3;
/// Approach speed below which a contact does not bounce, m/s. At 1 fails
/// `balls_that_meet_head_on_part_as_restitution_says`.
pub const BOUNCE_THRESHOLD: f64 = 0.01;
/// Speed with which what bounces swings on its contact, m/s, below which it does so no more. At
/// 0.01 fails `c8_a_ball_rebounds_with_the_coefficient_of_restitution_at_every_speed`, at 0
/// `what_has_bounced_and_rolls_on_takes_long_steps`.
pub const BOUNCED: f64 = 1e-3;
/// Tangential over normal stiffness: Mindlin's ratio for steel. At 0.01 fails
/// `a_sliding_block_stops_after_the_distance_of_its_dynamic_friction`.
pub const TANGENTIAL_RATIO: f64 = 0.8;
/// Overlap, in penetrations under the robot's weight, beyond which a point leaves the ground faster
/// than its damping alone would let it. Without it fails `c13_an_initial_overlap_leaves_gently`.
pub const DEEP_OVERLAP: f64 = 50.0;
/// Overlap, in the same, from which on nothing rubs: between the two friction fades, so that what
/// comes out of the ground is not held at once. At 1e9 fails
/// `what_begins_deep_in_others_is_not_thrown_out_by_friction`.
pub const SMOOTH_OVERLAP: f64 = 100.0;
/// How many times the speed with which it has come in a contact with such an overlap holds in its
/// spring where others have pressed it in: what has come in alone holds once that speed, or less.
/// At 1e9 fails `what_is_pressed_into_others_bounces_no_more`.
pub const PRESSED_IN: f64 = 2.0;
/// Separation speed of such an overlap, as a share of the speed that would carry it out
/// ballistically: at 1 it would hop, and `c13_an_initial_overlap_leaves_gently` fails.
pub const EMERGENCE: f64 = 0.7;
/// Force of a contact, in weights that its spring is made for, from which on the law softens with
/// which it leaves: an impact of usual speed stays below. At 1 fails
/// `friction_does_not_turn_a_slip_around_in_fixed_steps`, at 1e9
/// `a_rover_that_begins_askew_in_the_ground_rises_in_few_steps`.
pub const PRESSED: f64 = 100.0;
/// Crown of the flat face of a cylinder, as a share of its radius: over so much of a tilt its load
/// moves from the middle of the face to the rim. A face that is flat to the last bit would have a
/// moment that jumps. With the centre of mass four radii high it tips at 0.995 of the force of a
/// flat one. At 1 fails `a_can_that_was_nudged_comes_to_rest`.
pub const CROWN: f64 = 5e-5;
/// Square of the sine of the angle between the face below a standing cylinder and the normal of
/// their contact from which on the lowest place of a rim is that along the normal; where both
/// agree it is that against the face. At 0.01 fails
/// `depths_change_no_faster_than_shapes_move`, at 0
/// `cans_that_stand_on_each_other_askew_come_to_rest`.
pub const FACED: f64 = 1e-4;
/// Mean distance of a load from its middle where it presses evenly on a line, as a share of that of
/// its ends. At 3 fails `what_turns_on_the_spot_is_braked_by_an_even_pressure`.
pub const EVEN_LINE: f64 = 0.5;
/// Fewest corners among which an even pressure is shared where three or more points carry. A box
/// whose load leans to one side has fewer that count, but is no triangle: at 3, whose lever is 15 %
/// less, fails `the_communication_step_does_not_change_the_result_beyond_the_tolerance`.
pub const MIN_CORNERS: f64 = 4.0;
/// The same on a disc, as a share of its radius: `∫ r² dr / ∫ r dr`
/// (`a_spinning_disc_slows_down_by_friction_over_its_face`).
pub const EVEN_DISC: f64 = 2.0 / 3.0;
/// Radius of the curve of the forces that a disc or a square can bear where it hardly slides, in
/// caps: by its second derivative 0.667, and more on the way to sliding
/// (`what_slides_and_spins_goes_as_far_as_its_points_do_together`).
pub const EVEN_SPIN: f64 = 0.69;
/// Tangent of half of the angle at which that curve becomes flatter, where both of its ends have
/// the radius 1, and by how much it is more for what their radii are less together. So the curve
/// is nearest to sums over areas. With 0 for both, which makes it a circle, fails
/// `a_face_resists_as_its_points_do_together`.
pub const EVEN_TURN: [f64; 2] = [0.16, 0.1265];
/// Least and most share that one of the radii may be less than 1 by of what the other one is less
/// by: farther from each other no arc fits between
/// (`the_forces_that_a_face_can_bear_have_a_smooth_edge`).
pub const EVEN_BETWEEN: [f64; 2] = [0.4, 2.5];
/// What all faces can bear in any direction, in caps: a force that is shorter need not be looked
/// at. The least that one of them bears is 0.858; at 0.87 fails
/// `a_face_slips_along_the_normal_of_the_forces_that_it_bears`.
pub const EVEN_LEAST: f64 = 0.85;
/// Thickness of a face of a hull, in penetrations: corners that lie so near one plane share its
/// load. At 1e4 fails `even_terrain_carries_like_the_plane`.
pub const FACE: f64 = 3.0;
/// How much edges of a shape are rounded by to find the direction of contact with another shape, m,
/// at most, and as a share of its smallest half extent: what overlaps by less than both roundings
/// has a direction that does not jump. At 1e-7 fails
/// `the_contact_forces_of_two_links_are_opposite`.
pub const ROUNDING: f64 = 1e-3;
/// See [`ROUNDING`]. At 0.4 fails `bodies_that_meet_in_space_keep_their_momentum`.
pub const ROUNDING_SHARE: f64 = 0.02;
/// Number of squarings of the cosine between a face of a hull and the ground that gives the weight
/// with which its corners take the shares that they have in this face: at 10° a face counts by a
/// fiftieth. At 0 fails `a_split_corner_keeps_its_share`.
pub const FACING: u32 = 8;
/// Angle by which terrain turns down from one cell to the next at a sample that carries a shape as
/// a point does, rad. What is rounder is felt by the points of the shape. At 5 fails
/// `a_board_lies_on_four_nails_at_the_depth_of_the_law`.
pub const RIDGE: f64 = 0.5;
/// The same at a sample that carries nothing, rad: samples of a smooth hill are not felt by a wheel
/// that rolls over it. At 0 fails `a_ball_touches_smooth_hills_at_the_nearest_place_alone`.
pub const RIDGE_LEAST: f64 = 0.02;
/// Parts of the way of a ray over a cell of heights at whose ends it is asked whether it is below:
/// a bicubic surface may be crossed up to six times. At 0 fails
/// `rays_meet_heights_where_small_steps_do`.
pub const RAY_PARTS: u32 = 12;
/// How far below the lowest point of a surface of heights a ray ends, as a share of the surface's
/// extent: round-off must not end it above. At 0 fails
/// `rays_straight_down_meet_the_height_below_them`.
pub const RAY_BELOW: f64 = 1e-9;
/// Halvings by which a ray finds the surface: to round-off. At 10 fails
/// `rays_meet_heights_where_small_steps_do`.
pub const RAY_HALVINGS: u32 = 52;
/// Sine of the angle between two triangles of terrain below which their edge is even: 0.1°. Normals
/// as near to the edge between two patches belong to one of them. At 0 fails
/// `walls_and_floor_push_along_their_own_normals`.
pub const EVEN_EDGE: f64 = 1.7e-3;
/// Gap between triangles of terrain, or height of one over the other, below which the surface goes
/// on from one to the other, m: files are written in single precision. At 0 fails
/// `meshes_that_are_no_clean_surfaces_carry_like_clean_ones`.
pub const SEAM: f64 = 1e-6;
/// Sine up to which a direction out of a solid does not lean to a wall of it: round-off. At 1 fails
/// `what_slides_over_plates_side_by_side_slides_as_on_one`.
pub const LEAN: f64 = 1e-9;
/// What is left of a direction out of a solid without what leans to covered walls, at least: one
/// that points into a wall itself stays. What comes along a floor may be a step away, so that the
/// direction to it is nearly level: at 0.5 fails
/// `what_slides_over_plates_side_by_side_slides_as_on_one`.
pub const STRAIGHT: f64 = 1e-3;
/// Cosine between the normal of a face and the direction in which a shape comes upon a sharp sample
/// of heights up to which the face bounds the shape there: 60°. At 1, where all faces do, the many
/// faces of a round hull would, each for its neighbours; at -1 none does, and what slides comes
/// upon samples at once, see `what_slides_over_the_end_of_terrain_keeps_its_speed`.
pub const BESIDE: f64 = 0.5;
/// Sine of the angle beyond the directions of a crest from which on it no longer carries a shape
/// with flat faces: a face that lies on the next triangle has the normal of that triangle,
/// give or take round-off. At 1e-9 fails
/// `a_can_on_a_hill_of_small_triangles_stands_on_the_one_below_it`.
pub const CREST_SLACK: f64 = 0.02;
/// Looks by which the place of terrain nearest to a ball is found. Always so many, so that it
/// moves continuously; fewer only where another one would change nothing: on smooth ground four.
/// At 1 fails `a_ball_touches_smooth_hills_at_the_nearest_place_alone`.
pub const NEAREST_ON_FIELD: usize = 12;
/// The same where a ball may touch the surface in several places: each is looked for until it is
/// found. At 2 fails `a_ball_at_the_foot_of_a_slope_touches_both`.
pub const NEAREST_IN_HOLLOW: usize = 40;
/// How much the ground may bend against a circle, as seen along its normal, up to which the normal
/// leads to the only deepest place: its error falls by so much a look, to round-off in twelve. At
/// 1e9, where the normal alone leads, fails `a_ball_at_the_foot_of_a_slope_touches_both`.
pub const RING_ROUGH: f64 = 0.25;
/// Sine of the lean of a cylinder against the ground up to which it counts as standing there: where
/// the ground bends less against that, the rim of a can on a hill is a millimetre in it at most. At
/// 1e9 fails `a_ball_at_the_foot_of_a_slope_touches_both`.
pub const RING_LEAN: f64 = 0.05;
/// Sine of the lean of a circle against the ground at one of its deepest places up to which the
/// point is at the place itself on uneven ground. At 1e-9 fails
/// `a_cylinder_on_rough_heights_moves_as_its_rows_say`.
pub const RING_FLAT: f64 = 0.01;
/// Slope of the distance at the end of a step towards that place, as a share of the slope at its
/// start, beyond which the step has gone too far over a crest. Infinite fails
/// `what_rolls_over_a_step_of_heights_touches_it_all_the_way`.
pub const TOO_FAR: f64 = 0.5;
/// Places of one face of a shape on heights that are looked at for a bulge between its corners, at
/// most, but for some. At 16 fails `what_lies_across_a_smooth_hill_does_not_sink_into_it`.
pub const MOST_LOOKS: usize = 64;
/// Parts, at most, into which the axis of a capsule or a cylinder on heights is divided for such
/// places. At 4 fails `what_lies_across_a_smooth_hill_does_not_sink_into_it`.
pub const MOST_ON_LINE: usize = 16;
/// Places of a face or an axis that may act where heights bulge, at most: the deepest. At 1 fails
/// `what_lies_across_a_smooth_hill_does_not_sink_into_it`.
pub const MOST_BULGES: usize = 24;
/// How far smooth heights may rise between two places where a bulge is looked for, as a share of
/// the length over which faces take over from each other: a quarter of a millimetre. At 2.5 fails
/// `what_lies_across_a_smooth_hill_does_not_sink_into_it`.
pub const BULGE_BETWEEN: f64 = 0.25;
/// Bulge of heights that is round-off and carries nothing, as a share of the length over which
/// faces take over from each other. At 0 fails `a_ball_at_the_foot_of_a_slope_touches_both`.
pub const BULGE_LEAST: f64 = 1e-6;
/// Parts of the width of a ball in which its nearest places on heights are told apart. At 2 fails
/// `a_ball_at_the_foot_of_a_slope_touches_both`.
pub const HOLLOW_LOOKS: usize = 16;
/// Most such places: the ground, four walls, and what else is there. At 1 fails
/// `a_ball_at_the_foot_of_a_slope_touches_both`.
pub const MOST_NEAREST: usize = 8;
/// Cells along the longer side of heights that are generated. At 10 fails
/// `terrain_is_a_plane_heights_or_a_mesh`.
pub const TERRAIN_CELLS: f64 = 100.0;
/// The same at most. At 10 fails `terrain_refuses_what_means_nothing`.
pub const FINEST_TERRAIN: f64 = 1000.0;
/// Samples of terrain that one shape may lie on at a time: the deepest. At 3 fails
/// `a_board_lies_on_four_nails_at_the_depth_of_the_law`.
pub const MOST_PEAKS: usize = 16;
/// Angle that a contact turns by, rolling or drilling, before it gives way, under the load that its
/// stiffness is made for, rad. The patch of a tyre or a rubber ball turns by more, that of a steel
/// ball by less. At 0.1 fails `a_rolling_ball_slows_down_by_its_rolling_friction_and_stands`.
pub const TURN_DEFLECTION: f64 = 1e-3;

// Joints and motors: `law/motor.rs`, `force/joint.rs`.

/// Displacement of a velocity motor under its reference effort, rad or m. At 0.1 fails
/// `a_velocity_motor_follows_a_ramp_in_long_steps`.
pub const MOTOR_DEFLECTION: f64 = 1e-3;
/// Shortest relaxation time of a motor, s: keeps light joints from becoming needlessly stiff. At 1
/// fails `a_position_servo_follows_a_ramp_without_lag`.
pub const MOTOR_RELAXATION: f64 = 1e-3;
/// Position error of a position servo under its reference effort, rad or m. At 1 fails
/// `a_servo_pressed_against_a_limit_rests`.
pub const SERVO_DEFLECTION: f64 = 1e-3;
/// Share of the free effort that a position servo plans to brake with; the rest is kept for
/// disturbances. At 1 fails
/// `a_position_servo_reaches_its_target_without_overshoot_and_holds_it_under_load`.
pub const BRAKING_SHARE: f64 = 0.5;
/// Least free effort that it counts on, as a share of its effort: a servo whose load takes all of
/// its effort must still be told a speed. At 5 fails
/// `a_position_servo_reaches_its_target_without_overshoot_and_holds_it_under_load`.
pub const LEAST_FREE: f64 = 0.1;
/// Displacement of a joint's dry friction at break-away, rad or m. At 0.1 fails
/// `a_joint_breaks_away_at_its_static_friction_and_turns_with_its_dynamic_one`.
pub const FRICTION_DEFLECTION: f64 = 1e-4;
/// A limit can act within a step if it is nearer than so many times the way of the step, and a
/// margin, rad or m: the velocity may change within the step. At 0 for the first fails
/// `what_comes_to_its_limit_at_a_constant_speed_tries_one_step_in_vain_at_most`, at 1e9 for the
/// first or 1 for the second `limits_that_are_far_away_change_no_bit`.
pub const LIMIT_REACH: (f64, f64) = (2.0, 1e-6);

// Stiffness and restitution of contacts: `law/normal.rs`.

/// By how far a shape is moved to find the gradient of a depth, as a share of the thickness of the
/// contact. At 0.1 fails `rows_of_deep_contacts_are_the_gradient_of_their_depth`.
pub const NUDGE: f64 = 1e-5;
/// Least depth of two shapes, in ways of [`NUDGE`], at which the gradient of their depth is looked
/// for: a depth that a nudge ends has no slope there, and a rotation moves a place of contact by up
/// to twice the way. At 0 fails
/// `bodies_without_losses_make_no_energy_whatever_they_meet_with`.
pub const LIGHT: f64 = 4.0;
/// By how many times its way a shape that moves may change a depth that has a gradient: of random
/// pairs by up to 8. What changes more has jumped. At 1e9 fails
/// `what_begins_deep_in_others_is_not_thrown_out_whatever_its_restitution`.
pub const STEEPEST: f64 = 10.0;
/// Depth, in penetrations, up to which a contact stiffens: that of a load which is a million times
/// the weight. Beyond, it goes on with its tangent: steeper slopes would exceed what the digits of
/// a solve can balance. At 0.1 fails `nothing_passes_through_a_thin_plate`.
pub const STIFFEST: f64 = 30.0;

/// Least dissipation number: what loses nothing is damped by it all the same, so that the speed it
/// has come with can be told from its dissipation. At 0 fails
/// `balls_that_meet_head_on_part_as_restitution_says`.
pub const LEAST_NUMBER: f64 = 1e-12;
/// Relative accuracy of the speed with which a bounce ends. At 1e-2 fails
/// `a_body_that_its_weight_pushes_in_leaves_at_its_restitution`.
pub const RESTITUTION_ACCURACY: f64 = 1e-4;
/// Step of its integration, in times `√(m/K)` of the impact: an error of 1e-5 in the end. At 0.5
/// fails `balls_that_meet_head_on_part_as_restitution_says`.
pub const RESTITUTION_STEP: f64 = 0.05;
/// Most steps: an impact of a body without weight lasts some π of these times, one under its weight
/// hardly twice as long. At 10 fails `balls_that_meet_head_on_part_as_restitution_says`.
pub const RESTITUTION_STEPS: usize = 400;
/// Most tries of the search for its dissipation; a dozen are needed. At 4 fails
/// `a_body_that_its_weight_pushes_in_leaves_at_its_restitution`.
pub const RESTITUTION_TRIALS: usize = 40;

// Setting down: `step/settle.rs`.

/// Step in which friction is stretched, s: several times `2 √(m/k)` of friction. At 1e-4 fails
/// `a_cube_on_a_tilted_table_sticks_below_the_cone_and_slides_above`.
pub const SETTLING: f64 = 0.02;
/// How much heavier a joint becomes that does not move while the robot is set down. At 1000 fails
/// `a_robot_is_set_down_as_one_rigid_body`.
pub const LOCKED: f64 = 1e12;
/// Mass and inertia with which a driven base stands in the mass matrix, kg and kg·m²: 2¹⁰⁰, so that
/// no force changes a digit of what it does, and none is lost of its own acceleration. At 1e3 fails
/// `a_pendulum_hangs_on_what_is_driven`, whose loop would open.
pub const DRIVEN_MASS: f64 = 1_267_650_600_228_229_401_496_703_205_376.0;
/// Movement, m or rad, in the last of these steps below which a robot stands: a tenth of a
/// nanometre. One that tips over moves by millimetres. At 0 fails
/// `a_robot_is_set_down_as_one_rigid_body`, at 1 `what_tips_over_is_not_set_down`.
pub const SET_DOWN: f64 = 1e-10;
/// Number of these steps: each leaves less than a tenth of what is missing. At 0 fails
/// `a_cube_on_a_tilted_table_sticks_below_the_cone_and_slides_above`.
pub const SETTLING_STEPS: usize = 12;

// Inputs: `inputs.rs`. Outputs: `readout/pair.rs`, `readout/sample.rs`, `readout/touch.rs`.

/// Length of the mean of a pair's unit normals, weighted with the normal forces, below which they
/// cancel: fingers that press from two sides with forces that differ by round-off have no common
/// normal (`fingers_on_two_sides_of_a_cube_have_no_common_normal`).
pub const OPPOSED: f64 = 1e-6;
/// By how much of its terms' sizes an input that changes within a step may leave its range: slopes
/// of tables are quotients, whose round-off would take `max_effort` below 0 where it ends there. At
/// 0 fails `a_ramp_may_end_at_the_end_of_its_range`.
pub const RAMP_ROUND_OFF: f64 = 1e-9;
/// By how much of the time between two samples, beside the round-off of the times, a sensor's
/// sample may be early: times of communication points are sums, whose round-off would put it off to
/// the next one. Test: `a_sensor_takes_one_sample_at_each_of_its_times`.
pub const SAMPLE_EARLY: f64 = 1e-6;
/// How far beyond the box of a contact sensor places belong to it, as a share of its half extents:
/// the corners of a face lie on the border of a box as large as the face, and a load moves them by
/// micrometres. At 0 fails `the_border_of_a_box_belongs_to_it`.
pub const SENSED_BORDER: f64 = 1e-3;

// The convex solve: `step/convex`.

/// Newton iterations after which a solve gives up; random contact problems need up to 26. At 5
/// fails `the_minimum_does_not_depend_on_the_guess`.
pub const MAX_ITERATIONS: usize = 50;
/// Relative round-off of a sum of a few terms. At 1 fails
/// `the_minimum_does_not_depend_on_the_guess`.
pub const ROUND_OFF: f64 = 8.0 * f64::EPSILON;
/// Share of the initial slope at which the line search stops; a full Newton step may leave as much
/// uphill, and more downhill. A search that is a hundred times as exact needs as many iterations.
/// At 10 fails `the_minimum_does_not_depend_on_the_guess`.
pub const LINE_SEARCH_TOLERANCE: f64 = 0.1;
/// Tries of the line search, at most: every third halves the bracket, down to a millionth. At 1
/// fails `the_minimum_does_not_depend_on_the_guess`.
pub const LINE_SEARCH_TRIALS: usize = 60;
/// Share of the bracket at either end in which Newton's proposal gives way to bisection. At -1,
/// where Newton may leave the bracket, fails
/// `the_minimum_does_not_depend_on_the_hessian_of_the_first_iteration`.
pub const LINE_SEARCH_EDGE: f64 = 1e-3;

// Closed loops: `closure`, `step/closing.rs`, `initial/closing.rs`.

/// What is added to the diagonal of the matrix of the loops' forces, as a share of its mean
/// diagonal: a thousand times round-off, so that redundant rows share their force,
/// and a thousandth of what would be seen of it (`redundant_rows_share_their_force`).
pub const LOOP_COMPLIANCE: f64 = 1e-13;
/// Share of the largest pivot below which a row of a loop is redundant: ten thousand times
/// round-off (`bricards_mechanism_moves_and_keeps_its_energy`). What is left of two velocities is
/// round-off below this share of them (`a_loop_on_the_axis_of_a_joint_holds_nothing`), and its root
/// is what the message about such a loop takes for nothing.
pub const SPARE: f64 = 1e-12;
/// Weight of the motors' forces in loops beside the accelerations that they leave, both in units of
/// what a motor alone does: motors that hold the same joints share their load, near a singular
/// place none counts on more than 500 times what it carries elsewhere, and loads err by a
/// millionth. At 0 fails `motors_that_hold_the_same_loop_share_its_load`.
pub const SHARED_LOAD: f64 = 1e-3;
/// Least reach with which angles of a loop count, m: that of a tree. At 10 fails
/// `the_force_of_a_loop_is_what_it_carries`.
pub const LEAST_LEVER: f64 = 0.01;
/// Gap to which positions are projected, m: ten times the round-off of a metre. At 1e-6 fails
/// `a_four_bar_stays_closed_and_keeps_its_energy`.
pub const CLOSED: f64 = 1e-14;
/// Gap that a step may leave, m; one that leaves more is tried again at half its length. At 0 fails
/// `a_four_bar_stays_closed_and_keeps_its_energy`.
pub const OPEN: f64 = 1e-10;
/// Most tries to project positions. Two or three are needed; at a singular place, where the gap
/// falls by a quarter in each, twenty. At 1 fails `a_four_bar_stays_closed_and_keeps_its_energy`.
pub const PROJECTIONS: usize = 30;
/// Most tries to take the velocity out of the rows; each leaves a millionth and less. At 0 fails
/// `bricards_mechanism_moves_and_keeps_its_energy`.
pub const STOPPED: usize = 4;
/// Most tries to close the initial pose from one start. At 3 fails
/// `random_loops_stay_closed_and_keep_energy_and_momenta`.
pub const CLOSING_TRIES: usize = 200;
/// Longest way of a degree of freedom in one try to close the initial pose, weighted, m. At 1e-6
/// fails `notes_couple_joints_weld_links_and_hang_springs`.
pub const CLOSING_WAY: f64 = 0.3;
/// Gap up to which an initial pose counts as closed, m. At 1 fails
/// `changed_initial_values_close_or_tell_the_gap`.
pub const CLOSED_START: f64 = 1e-9;
/// How much heavier a floating base is when the initial pose is closed: it stays where it has been
/// put as long as joints can close the loops. At 0 fails `loops_move_like_joints_of_a_tree`.
pub const BASE_WEIGHT: f64 = 1e3;
/// Starts that are tried to close the initial pose: the given one, and others nearby, because a
/// stretched-out mechanism does not know which way to bend. At 1 fails
/// `a_loop_that_cannot_close_is_an_error_with_its_gap_and_its_place`.
pub const CLOSING_STARTS: usize = 12;
/// How far the last of these is off, weighted, m. At 0 fails
/// `a_loop_that_cannot_close_is_an_error_with_its_gap_and_its_place`.
pub const CLOSING_SPREAD: f64 = 1.5;

// Differential equations: `continuous.rs`.

/// Stiffness of a limit, in those with which the joint's motor holds it, up to which an integrator
/// may go on with its slopes where the joint has left the limit: it takes a solution for converged
/// at a tenth of its tolerance, and is then off by at most that. At 0.5 and at 1e9 fails
/// `a_joint_that_has_left_its_limit_is_announced_unless_its_motor_holds_it`.
pub const HELD: f64 = 10.0;
/// Speed at which what touches has left although it still overlaps, in those from which on nothing
/// pushes it. At 1 it would cross that speed again and again: with 1 and with 1e9 fails
/// `test_what_has_landed_stays_on_the_ground`.
pub const LEFT: f64 = 2.0;
/// Longest time until the next event where shapes could pass each other, s: an event costs an
/// implicit integrator a Jacobian, and after each of its steps it is told whether it has to come
/// earlier. At 0.01 fails `what_falls_on_thin_things_is_announced_in_time`.
pub const PLAN: f64 = 10.0;
/// Shortest such time, s: shapes of a hundredth of a millimetre at ten metres a second. At 0.1
/// fails `what_falls_on_thin_things_is_announced_in_time`.
pub const LEAST_PLAN: f64 = 1e-6;
/// How fast a quaternion among continuous states comes back to unit length, 1/s: slower than
/// anything that an importer resolves, and faster than its errors add up. At 0 fails
/// `quaternions_come_back_to_unit_length`.
pub const QUATERNION_RATE: f64 = 1.0;
/// Most continuous states: importers factor a matrix with a row and a column for each. Without it
/// fails `a_model_of_too_many_states_is_refused`.
pub const MOST_STATES: usize = 500;
/// Increments of the differences that stand for a partial derivative, in parts of the nominal
/// value: two of them, of which one is half of the other, leave an error of fourth order. At 1e-6
/// contacts of a wheel are off by 2e-6, at 3e-8 the digits of the forces run out. At 1e-6 fails
/// `test_directional_derivatives_are_those_of_differences`.
pub const DIFFERENCE: f64 = 3e-7;
