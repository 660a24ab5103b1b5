use super::*;

#[test]
fn a_file_expanded_from_xacro_gets_a_name_that_ends_in_urdf() {
    assert_eq!(urdf_name("a/rover.urdf.xacro"), "a/rover.urdf");
    assert_eq!(urdf_name("a/rover.xacro"), "a/rover.urdf");
    assert!(is_xacro(Path::new("a.XACRO")) && !is_xacro(Path::new("xacro.urdf")));
}

#[test]
fn only_what_defines_something_is_taken_for_xacro() {
    assert!(defines("<robot><xacro:arg name='a' default='1'/></robot>"));
    assert!(defines("<robot><xacro:if value='1'/></robot>"));
    // A call whose macro is nowhere, and what stands in a comment.
    assert!(!defines("<robot><xacro:wheel/></robot>"));
    assert!(!defines("<robot><!-- <xacro:macro name='a'/> --></robot>"));
    assert!(!defines("<robot xmlns:xacro='x'/>"));
}
